// What players of a body and of a mechanism have in common: the time that is shown, the side that the pictures are seen from,
// playing, and the description of pictures that stand still.
// Uses controls.js.

// figure, panels, controls: those of the player. end: of the motion (s). now, azimuth, elevation: shown at first.
// lowest: the least elevation (rad). look: prepares pictures from a side. paint: draws them at a time.
// describe: describes them. changeSpeed: is called when the reader chooses another speed.
// Returns `again`, which prepares and draws the pictures anew.
const staged = ({ figure, panels, controls, end, lowest, look, paint, describe, changeSpeed, ...first }) => {
  let { now, azimuth, elevation } = first;
  let pending = 0;
  const draw = () => {
    paint(now);
    controls.showTime(now);
    if (player.isPlaying()) return;
    // Pictures are described once they have stood still for half a second.
    clearTimeout(pending);
    pending = setTimeout(describe, 500);
  };
  const again = () => {
    look(azimuth, elevation);
    controls.showSide(azimuth);
    draw();
  };
  const move = (t) => {
    now = Math.min(end, Math.max(0, t));
    draw();
  };
  const turn = (about, above) => {
    [azimuth, elevation] = [about, Math.min(1.4, Math.max(lowest, above))];
    again();
  };
  const player = playing(
    (elapsed) => {
      const next = now + elapsed * controls.speed.value;
      move(next > end ? 0 : next);
    },
    (isPlaying) => {
      controls.showPlaying(isPlaying);
      if (!isPlaying) draw();
    },
  );
  connect(controls, end, {
    toggle: player.toggle,
    moveTo: move,
    moveBy: (step) => move(now + step),
    turnTo: (about) => turn(about, elevation),
    changeSpeed,
  });
  panels.forEach(({ picture }) =>
    picture.addEventListener("pointermove", (event) => {
      if (event.buttons & 1) turn(azimuth - event.movementX / 100, elevation + event.movementY / 100);
    }),
  );
  new IntersectionObserver(([{ isIntersecting }]) => isIntersecting || player.stop()).observe(figure);
  return { again };
};
