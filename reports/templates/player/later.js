// Adds the function `play`, with which a page makes a player in a `figure` when it has loaded the data.
// Uses player.js.
window.play = (figure, data) => {
  build(figure, data);
  figure.dataset.ready = "yes";
};
