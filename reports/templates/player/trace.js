// The errors of the shown runs over time, in a strip under the pictures, with a line at the shown time.
// Uses elements.js.

// The number of steps of a curve, and the height of the strip in pixels.
const [STEPS, STRIP] = [200, 60];

// end: the last instant of the motion (s). errorsOf: returns the errors of the shown runs at a time, each with its angle (rad) and
// its shift (m). The strip shows angles unless none is larger than `least` (rad). moveTo: changes the shown time.
const traceOf = (end, errorsOf, least, moveTo) => {
  const picture = svg("svg", { viewBox: `0 0 ${STEPS} ${STRIP}`, preserveAspectRatio: "none", class: "drawing trace", "aria-hidden": "true" });
  const curves = picture.appendChild(svg("g", {}));
  const line = addPath(picture, "now");
  const words = html("p", { class: "reading" });
  picture.addEventListener("pointermove", (event) => event.buttons & 1 && moveTo((end * event.offsetX) / picture.clientWidth));
  picture.addEventListener("click", (event) => moveTo((end * event.offsetX) / picture.clientWidth));

  // shown: the shown runs with their colours.
  const choose = (shown) => {
    const errors = Array.from({ length: STEPS + 1 }, (_, k) => errorsOf((end * k) / STEPS));
    const largestAngle = Math.max(0, ...errors.flat().map(({ angle }) => angle));
    const [kind, unit] = largestAngle > least ? ["angle", "rad"] : ["shift", "m"];
    const largest = Math.max(0, ...errors.flat().map((error) => error[kind]));
    const heights = shown.map((_, k) => errors.map((error) => STRIP - 3 - (STRIP - 6) * (largest && error[k][kind] / largest)));
    curves.replaceChildren(...shown.map(({ colour }, k) => svg("path", { stroke: colour, d: `M${heights[k].map((y, x) => `${x} ${y.toFixed(1)}`).join("L")}` })));
    words.textContent = largest ? `Error over time, at most ${number(largest, 2)} ${unit}` : "The errors are too small to be drawn over time.";
  };
  const at = (now) => assign(line, { d: `M${((STEPS * now) / end).toFixed(2)} 0V${STRIP}` });
  return { element: html("div", { class: "strip" }, words, picture), choose, at };
};
