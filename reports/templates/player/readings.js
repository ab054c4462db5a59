// What is written under the pictures and said of them to readers who do not see them.
// Uses vectors.js and elements.js.

// rad: bodies whose attitudes differ by less cannot be told apart, as each is drawn within `within` of its samples.
const indistinct = (within) => 2.5 * within;

// How far a run is from the truth: the difference of attitudes (rad), and the words.
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

// Names the pictures for what they show, and tells it to screen readers if the reader is using this player.
// panels: of the truth, then of the runs shown. status: the element that screen readers announce.
const announce = (figure, panels, shown, time, status) => {
  const attitude = panels[0].picture.dataset.quaternion.split(",").map(Number);
  const axis = rotate(attitude, AXES[2]).map((x) => number(x, 2));
  const names = [`the truth, its axis K along (${axis.join(", ")})`, ...shown.map(({ label }) => label)];
  const sayings = panels.map(({ words }, k) => `${names[k]}: ${words.textContent}`);
  panels.forEach(({ picture }, k) => picture.setAttribute("aria-label", `At ${time}, ${sayings[k]}`));
  if (status.textContent || document.activeElement?.closest(".player") === figure) status.textContent = `At ${time}: ${sayings.join("; ")}.`;
};
