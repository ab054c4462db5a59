// Lets a page make a player of a `figure` when it has the data.
// Uses player.js.
window.play = (figure, data) => {
  build(figure, data);
  figure.dataset.ready = "yes";
};
