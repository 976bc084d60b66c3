// Uses the page as a person would and logs what happened. In a scope of its own.
(() => {

const pause = (milliseconds) => new Promise((done) => setTimeout(done, milliseconds));

/** A number for the pixels of a canvas, how many colours they have, and how many are of a ball's red. */
function look(canvas) {
  const { data } = canvas.getContext("2d").getImageData(0, 0, canvas.width, canvas.height);
  const colors = new Set();
  let [sum, red] = [0, 0];
  for (let i = 0; i < data.length; i += 4) {
    const color = (data[i] << 16) | (data[i + 1] << 8) | data[i + 2];
    colors.add(color);
    // The paths' red has no blue.
    if (data[i] > 120 && 2 * data[i + 1] < data[i] && 2 * data[i + 2] < data[i] && 8 * data[i + 2] > data[i]) red++;
    sum = (Math.imul(sum, 31) + color) | 0;
  }
  return { sum, red, colors: colors.size };
}

function press(canvas, key) {
  canvas.dispatchEvent(new KeyboardEvent("keydown", { key, bubbles: true, cancelable: true }));
}

/** Until something holds, as the browser may be slow. */
async function until(holds) {
  for (let i = 0; i < 600 && !holds(); i++) await pause(50);
}

async function probe(article) {
  article.scrollIntoView({ behavior: "instant" });
  await until(() => article.querySelectorAll(".plot .cursor").length > 0);
  await pause(200);
  const find = (selector) => article.querySelector(selector);
  const [canvas, play, scrub] = [find("canvas"), find(".play"), find(".scrub")];
  const time = () => Number(scrub.value);
  const cursor = () => find(".cursor").getAttribute("transform");
  const found = { title: find("h3").textContent, start: time() };
  // Copies of the robot are pale; it must be seen itself.
  find(".copies").click();
  const [before, cursorBefore] = [look(canvas), cursor()];
  [found.colors, found.red] = [before.colors, before.red];

  play.click();
  await until(() => time() > 0.1);
  play.click();
  found.played = time();
  found.pictureMoved = look(canvas).sum !== before.sum;
  found.cursorMoved = cursor() !== cursorBefore;
  await pause(300);
  found.afterPause = time();

  // The middle of the time axis, one second.
  const drawing = find(".plot:last-child .drawing");
  drawing.scrollIntoView({ behavior: "instant" });
  const box = drawing.getBoundingClientRect();
  const axis = drawing.querySelector(".cursor").ownerSVGElement.querySelector(".zero, .grid").getBoundingClientRect();
  drawing.setPointerCapture = () => {};
  const at = { clientX: axis.left + axis.width / 2, clientY: box.top + box.height / 2 };
  drawing.dispatchEvent(new PointerEvent("pointerdown", { ...at, button: 0, pointerId: 1, bubbles: true }));
  found.clicked = time();

  // Scrolling would go on smoothly while the next run is tried.
  canvas.focus({ preventScroll: true });
  const unturned = look(canvas).sum;
  press(canvas, "ArrowLeft");
  found.keyTurned = look(canvas).sum !== unturned;
  press(canvas, " ");
  await until(() => time() > 1.1);
  press(canvas, " ");
  found.keyPlayed = time() > 1.05;
  found.plots = article.querySelectorAll(".plot svg[role=img]").length;
  return found;
}

/** Things that can have the focus but have no name. */
function unlabelled() {
  const all = [...document.querySelectorAll("a, button, input, select, summary, [tabindex]")];
  const name = (element) =>
    element.getAttribute("aria-label") || element.getAttribute("aria-labelledby") ||
    element.closest("label")?.textContent.trim() || element.textContent.trim();
  return all.filter((element) => !name(element)).map((element) => element.outerHTML);
}

(async () => {
  const result = { runs: [], unlabelled: unlabelled() };
  try {
    for (const article of document.querySelectorAll("article.run")) result.runs.push(await probe(article));
    result.renderer = Pictures.renderer.constructor.name;
  } catch (error) {
    window.complaints.push(String(error.stack));
  }
  result.errors = window.complaints;
  console.log(`PROBE:${JSON.stringify(result)};END`);
})();
})();
