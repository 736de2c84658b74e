// One colour per controller everywhere, as sim/show/figure/palette.h gives it: the baseline's, then in the order of the verdict.
let colours = [];

function colourName(controller) { return colours[controller]; }

// Of a translucent hand.
function tintName(controller) {
  const colour = colourName(controller);
  return colour === "var(--c0)" ? "var(--second)" : colour;
}

// Canvas does not know variables.
function resolvedColour(name) {
  const variable = /^var\((.+)\)$/.exec(name);
  if (!variable) return name;
  return getComputedStyle(document.documentElement).getPropertyValue(variable[1]).trim();
}

function dot(controller) {
  return element("span", {class: "dot", style: `--colour: ${colourName(controller)}`});
}

function controllerLabel(data, controller) {
  return [dot(controller), ...breakable(data.controllers[controller].name)];
}
