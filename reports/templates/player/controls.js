// The controls of a player: play and pause, the time, the speed, and the direction of view.
// Uses vectors.js and elements.js.

// The time (s) between two pictures on most screens.
const FRAME = 1 / 60;
const ICONS = { play: "M3 1.5 13 8 3 14.5z", pause: "M3 2h3.5v12H3zM9.5 2H13v12H9.5z" };

const controlsOf = (end, fastest) => {
  const slider = html("input", { type: "range", min: 0, max: end, step: "any", value: 0, "aria-label": "Time" });
  const clock = html("span", { class: "clock" });
  const icon = svg("path", { d: ICONS.play });
  const word = html("span", {}, "Play");
  const button = html("button", { type: "button" }, svg("svg", { viewBox: "0 0 16 16", "aria-hidden": "true" }, icon), word);
  const speed = html("select", { "aria-label": "Speed" });
  const side = html("input", { type: "range", min: -180, max: 180, step: 5, "aria-label": "Seen from" });
  const sideLabel = html("label", { class: "side" }, "seen from ", side);
  const element = html("div", { class: "controls", role: "group", "aria-label": "Playback" }, button, slider, clock, speed, sideLabel);

  const rates = [];
  for (let rate = nice(end / 2000); rate <= end; rate = nice(1.5 * rate)) rates.push(rate);
  speed.append(...rates.map((rate) => html("option", { value: rate }, rate === 1 ? "real time" : `${number(rate)} × real time`)));
  // The initial speed is the largest that eyes can follow and that takes at least six seconds, but at most real time.
  const steady = rates.filter((rate) => rate <= 1 && fastest * rate * FRAME < 0.3);
  speed.value = steady.filter((rate) => end / rate >= 6).pop() ?? steady[0] ?? rates[0];

  const showTime = (t) => {
    slider.value = t;
    clock.textContent = seconds(t, end);
    slider.setAttribute("aria-valuetext", `${seconds(t, end)} of ${seconds(end, end)}`);
  };
  const showSide = (azimuth) => {
    side.value = Math.round((Math.atan2(Math.sin(azimuth), Math.cos(azimuth)) * 180) / Math.PI);
    side.setAttribute("aria-valuetext", `${side.value}° about the vertical`);
  };
  const showPlaying = (isPlaying) => {
    icon.setAttribute("d", isPlaying ? ICONS.pause : ICONS.play);
    word.textContent = isPlaying ? "Pause" : "Play";
  };
  return { element, slider, clock, button, speed, side, showTime, showSide, showPlaying };
};

// Connects the controls, used with the pointer or with keys, to the functions of a player.
const connect = ({ slider, button, speed, side }, end, { toggle, moveTo, moveBy, turnTo, changeSpeed }) => {
  button.addEventListener("click", toggle);
  slider.addEventListener("input", () => moveTo(Number(slider.value)));
  slider.addEventListener("keydown", (event) => {
    const step = end / 200;
    const steps = { ArrowRight: step, ArrowUp: step, ArrowLeft: -step, ArrowDown: -step, PageUp: 10 * step, PageDown: -10 * step };
    if (event.key === " ") toggle();
    else if (event.key in steps) moveBy(steps[event.key]);
    else return;
    event.preventDefault();
  });
  speed.addEventListener("change", changeSpeed);
  side.addEventListener("input", () => turnTo((side.value * Math.PI) / 180));
};

// Playing: while a player plays, `advance` is called before each picture with the time (s) that has passed on the page.
// `changed` is called when it starts or stops. Only one player of a page plays at a time.
const stops = new Set();
const playing = (advance, changed) => {
  let [isPlaying, before] = [false, 0];
  const tick = (stamp) => {
    if (!isPlaying) return;
    const elapsed = Math.min(0.5, (stamp - before) / 1000); // a page that was hidden continues where it stopped
    before = stamp;
    advance(elapsed);
    requestAnimationFrame(tick);
  };
  const play = (wanted) => {
    isPlaying = wanted;
    changed(isPlaying);
    if (!isPlaying) return;
    stops.forEach((other) => other !== stop && other());
    before = performance.now();
    requestAnimationFrame(tick);
  };
  const stop = () => isPlaying && play(false);
  stops.add(stop);
  return { toggle: () => play(!isPlaying), stop, isPlaying: () => isPlaying };
};
