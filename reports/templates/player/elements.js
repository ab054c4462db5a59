// Elements of the page, and numbers as text.
const assign = (element, attributes) => {
  for (const [name, value] of Object.entries(attributes)) element.setAttribute(name, value);
  return element;
};
const filled = (element, attributes, children) => {
  assign(element, attributes).append(...children);
  return element;
};
const html = (name, attributes, ...children) => filled(document.createElement(name), attributes, children);
const svg = (name, attributes, ...children) => filled(document.createElementNS("http://www.w3.org/2000/svg", name), attributes, children);
const addPath = (parent, kind, attributes = {}) => parent.appendChild(svg("path", { class: kind, ...attributes }));

const number = (value, digits = 3) => String(Number(value.toPrecision(digits)));
const atMost = (value) => (value ? `≤ ${number(value, 2)}` : "0");
const seconds = (t, end) => `${t.toFixed(Math.max(0, 3 - Math.ceil(Math.log10(end))))} s`;
// Returns the least number of the form 1, 2 or 5 times a power of ten that is not below a value.
const nice = (value) => {
  const power = Math.floor(Math.log10(value) + 1e-9);
  return Number(`${[1, 2, 5, 10].find((digit) => digit * 10 ** power >= value * (1 - 1e-9))}e${power}`);
};
