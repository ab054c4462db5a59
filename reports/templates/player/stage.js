// The common part of the players of a body and of a mechanism: the shown time, the direction of view, playing, and the description
// of pictures while they are not playing.
// Uses controls.js.

// figure, panels, controls: the parts of the player. end: the last instant of the motion (s). now, azimuth, elevation: the initial
// time (s) and direction of view (rad). lowest: the least elevation (rad). look: prepares the pictures for a direction of view.
// paint: draws the pictures at a time. describe: describes the pictures. changeSpeed: is called when the reader changes the speed.
// Returns the function `again`, which prepares and draws the pictures again, and `move`, which changes the shown time.
const staged = ({ figure, panels, controls, end, lowest, look, paint, describe, changeSpeed, ...first }) => {
  let { now, azimuth, elevation } = first;
  let pending = 0;
  const draw = () => {
    paint(now);
    controls.showTime(now);
    if (player.isPlaying()) return;
    // Pictures are described when they have not changed for half a second.
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
  return { again, move };
};
