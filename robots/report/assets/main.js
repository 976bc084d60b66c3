// Brings the page to life.

const report = JSON.parse(document.getElementById("data").textContent);
const runs = report.runs.map((raw) => new Run(raw, report.robots));
const articles = [...document.querySelectorAll("article.run")];
const players = articles.map((article, i) => new Player(article, runs[i]));
let isPrinting = false;

document.documentElement.classList.add("alive");
document.querySelectorAll(".thumbnail").forEach((place, i) => (place.innerHTML = thumbnail(runs[i])));
document.querySelectorAll(".poles").forEach((place) => {
  const poles = report.robots[Number(place.dataset.robot)].poles;
  place.innerHTML = polePlot(...poles);
});

// Runs are drawn when they come near, and stop when they are out of sight.
const near = new IntersectionObserver(
  (entries) => {
    for (const { target, isIntersecting } of entries) {
      if (isIntersecting) players[articles.indexOf(target)].build();
    }
  },
  { rootMargin: "400px" },
);
const sight = new IntersectionObserver((entries) => {
  for (const { target, isIntersecting } of entries) {
    if (!isIntersecting) players[articles.indexOf(target)].pause();
  }
});
for (const article of articles) {
  near.observe(article);
  sight.observe(article);
}

prefersDark.addEventListener("change", () => players.forEach((player) => player.draw()));
prefersStill.addEventListener("change", () => players.forEach((player) => player.pause()));

// On paper everything is shown; afterwards the page is as it was.
/** Width of a plot on paper, in units of its text. */
const PAPER_WIDTH = 380;
let opened = [];
addEventListener("beforeprint", () => {
  isPrinting = true;
  opened = [...document.querySelectorAll("details:not([open])")];
  for (const details of opened) details.open = true;
  for (const player of players) {
    player.build();
    player.fit(PAPER_WIDTH);
    player.draw();
  }
});
addEventListener("afterprint", () => {
  isPrinting = false;
  for (const details of opened) details.open = false;
  for (const player of players) {
    if (!player.isBuilt) continue;
    player.fit();
    player.draw();
  }
});
