// One colour per controller everywhere on the page. Eight are chosen by hand for both grounds;
// beyond, hues far from each other.
function colourName(controller) {
  return controller < 8 ? `var(--c${controller})` : `hsl(${(controller * 137.5) % 360} 55% 52%)`;
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
