// Texts under the pictures, and descriptions of the pictures for screen readers.
// Uses vectors.js and elements.js.

// The angle (rad) below which the attitudes of two bodies cannot be distinguished, since each has an error of up to `within` rad.
const indistinct = (within) => 2.5 * within;

// Returns the difference of a run from the truth: the angle between the attitudes (rad), and the words below the picture.
const differenceOf = (run, state, truth, { plane, within, body: { reach } }) => {
  const angle = angleBetween(state.attitude, truth.attitude);
  const least = indistinct(within);
  const turned = run.turnsAlike ? atMost(run.attitude_error) : angle < least ? `< ${least}` : number(angle);
  const shift = length(plane ? minus(state.place, truth.place) : state.place) * reach;
  const unsure = run.course ? 2 * run.course.within * reach : Infinity;
  const shifted = shift > 3 * unsure ? number(shift, 2) : atMost(Math.min(run.position_error, shift + unsure));
  return { angle, words: `off by ${turned} rad\nand ${shifted} m` };
};
const turningWords = (state) => `turning at\n${number(length(state.rate))} rad/s`;

// Describes the pictures, and lets screen readers announce the descriptions if the reader is using this player.
// panels: the panel of the truth, then the panels of the shown runs. status: the element that screen readers announce.
const announce = (figure, panels, shown, time, status) => {
  const attitude = panels[0].picture.dataset.quaternion.split(",").map(Number);
  const axis = rotate(attitude, AXES[2]).map((x) => number(x, 2));
  const names = [`the truth, its axis K along (${axis.join(", ")})`, ...shown.map(({ label }) => label)];
  const descriptions = panels.map(({ words }, k) => `${names[k]}: ${words.textContent}`);
  panels.forEach(({ picture }, k) => picture.setAttribute("aria-label", `At ${time}, ${descriptions[k]}`));
  if (status.textContent || document.activeElement?.closest(".player") === figure) status.textContent = `At ${time}: ${descriptions.join("; ")}.`;
};
