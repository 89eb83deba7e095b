// Elements of drawings.

const namespace = 'http://www.w3.org/2000/svg';

/** @returns {any} an SVG element with these attributes and children */
export function svg(tag, attributes = {}, ...children) {
  const made = document.createElementNS(namespace, tag);
  for (const [name, value] of Object.entries(attributes)) made.setAttribute(name, String(value));
  made.append(...children);
  return made;
}

/** @returns {any} the same with that class, at the end of `parent` */
export function svgIn(parent, tag, className = '') {
  const made = svg(tag, className ? { class: className } : {});
  parent.append(made);
  return made;
}
