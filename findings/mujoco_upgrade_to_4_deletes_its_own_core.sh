#!/bin/bash
# mujoco 3.17.0 and 4.0.0 (PyPI), Python 3.11: a plain `pip install --upgrade` from one to the other.
#
# Guess: pip leaves a package that can be imported, as after every upgrade before; if not, `pip check` says so.
# Seen: `import mujoco` ends with an ImportError. 4.0.0 is divided into packages whose files have the places of the old
# one. pip installs the new core first, then uninstalls 3.17.0, and with it the files of the core that have the same
# names. `pip check` finds no fault, and a second upgrade changes nothing. Its changelog asks to uninstall first.
# Exit code 0: seen again; 1: something else.
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
python3.11 -m venv "$folder/venv"
pip=("$folder/venv/bin/pip" -q --disable-pip-version-check)
python=$folder/venv/bin/python
"${pip[@]}" install mujoco==3.17.0
"$python" -c 'import mujoco; print("before:", mujoco.__version__)'
"${pip[@]}" install --upgrade mujoco==4.0.0
"${pip[@]}" check
if message=$("$python" -c 'import mujoco' 2>&1); then
  echo "after: it can be imported"
  exit 1
fi
grep -o "ImportError: .*core bindings" <<<"$message"
"${pip[@]}" install --upgrade mujoco==4.0.0
! "$python" -c 'import mujoco' 2>/dev/null
"${pip[@]}" install --force-reinstall --no-deps mujoco==4.0.0 mujoco-core==4.0.0
"$python" -c 'import mujoco; print("installed anew:", mujoco.__version__)'
