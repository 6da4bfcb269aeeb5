// SPDX-License-Identifier: GPL-3.0-or-later
// What a reader does with a report page: node drive.mjs PAGE CHECK... Ends with status 1 at the first
// thing that is not as it should be.
import assert from "node:assert/strict";
import { drawn, launch, NARROW, open, picture, slide } from "./browser.mjs";

const [file, ...checks] = process.argv.slice(2);
const state = (page, name) => page.locator(".player").first().evaluate((player, key) => Number(player.dataset[key]), name);
const ring = (page) => page.locator(".chart .here").first().evaluate((mark) => [mark.getAttribute("cx"), mark.getAttribute("cy")]);

const CHECKS = {
  // Every control changes the picture, and what it should change.
  async replay(browser) {
    const { page, complaints, close } = await open(browser, file);
    await drawn(page);
    assert.equal(await state(page, "time"), 0);
    const start = await picture(page), ringAtStart = await ring(page);
    assert.equal(await picture(page), start, "a replay at rest stays as it is");
    const gap = Number(await page.locator(".stage").first().getAttribute("data-gap-pixels"));
    assert.ok(gap >= 8, `the clearance is drawn ${gap} pixels wide`);

    await page.getByRole("button", { name: "Play" }).first().click();
    await page.waitForFunction(() => Number(document.querySelector(".player").dataset.time) > 0.02);
    await page.getByRole("button", { name: "Pause" }).first().click();
    const paused = await state(page, "time");
    assert.notEqual(await picture(page), start, "playing changes the picture");
    assert.equal(await state(page, "time"), paused, "pause stops it");

    await slide(page, "Time", 0.6);
    assert.equal(await state(page, "time"), 0.6);
    const later = await picture(page);
    assert.notEqual(later, start, "the time slider changes the picture");
    assert.notDeepEqual(await ring(page), ringAtStart, "the mark in the chart follows");

    await slide(page, "Temperature change", 0.25);
    const change = await state(page, "temperature");
    assert.ok(Math.abs(change - 25) < 0.1, `a quarter of 100 K is ${change} K`);
    assert.ok((await state(page, "time")) > 0.5, "on the branch where the replay stood");
    await slide(page, "Time", 0.6);

    await slide(page, "Clearance", 0);
    assert.equal(await state(page, "clearance"), 1);
    const plain = await picture(page);
    assert.notEqual(plain, later, "the magnification changes the picture");
    if (await page.getByLabel("magnify both alike").count()) {
      assert.equal(await state(page, "deformation"), 1, "both magnifications go together");
      await page.getByLabel("magnify both alike").uncheck();
      await slide(page, "Deformation", 0.5);
      assert.equal(await state(page, "clearance"), 1, "and apart when asked to");
      assert.notEqual(await picture(page), plain);
    }

    for (const view of ["Front", "Top", "Joint", "Oblique"]) {
      const before = await picture(page);
      await page.getByRole("button", { name: view, exact: true }).first().click();
      assert.notEqual(await picture(page), before, `view ${view}`);
    }
    await page.locator("select").first().selectOption({ index: 0 });
    assert.deepEqual(complaints, []);
    await close();
  },

  async keyboard(browser) {
    const { page, complaints, close } = await open(browser, file, { reducedMotion: "reduce" });
    await drawn(page);
    const player = page.locator(".player").first();
    await player.focus();
    await page.keyboard.press("ArrowRight");
    assert.equal(await state(page, "time"), 0.005);
    await page.keyboard.press("Shift+ArrowRight");
    const event = await state(page, "time");
    const times = await page.locator(".events [data-time]").evaluateAll((rows) => rows.map((row) => Number(row.dataset.time)));
    assert.ok(times.includes(event), `${event} s is an event of the table`);
    await page.keyboard.press("End");
    assert.equal(await state(page, "time"), 1);
    const before = await state(page, "clearance");
    await page.keyboard.press("+");
    assert.ok((await state(page, "clearance")) > before);
    const model = () => page.getByLabel("Model").first().inputValue();
    const first = await model();
    await page.keyboard.press("m");
    assert.notEqual(await model(), first);
    await page.keyboard.press("f");
    assert.equal(await page.getByLabel("forces").first().isChecked(), false);
    await page.keyboard.press("Home");
    await page.keyboard.press("Space");
    await page.waitForFunction(() => Number(document.querySelector(".player").dataset.time) > 0);
    assert.deepEqual(complaints, []);
    await close();
  },

  async themes(browser) {
    const { page, complaints, close } = await open(browser, file, { colorScheme: "dark" });
    await drawn(page);
    const paper = () => page.evaluate(() => getComputedStyle(document.body).backgroundColor);
    const dark = await paper(), darkPicture = await picture(page);
    await page.locator("#theme").click(); // from automatic to light
    assert.notEqual(await paper(), dark);
    assert.notEqual(await picture(page), darkPicture);
    await page.reload();
    assert.equal(await page.locator("#theme").textContent(), "Theme: light", "the choice is kept");
    assert.deepEqual(complaints, []);
    await close();
  },

  async narrow(browser) {
    const { page, complaints, close } = await open(browser, file, NARROW);
    await drawn(page);
    // A phone's browser shrinks a page that is too wide: innerWidth would grow with it.
    const overflow = (await page.evaluate(() => document.documentElement.scrollWidth)) - NARROW.viewport.width;
    assert.ok(overflow <= 0, `the page is ${overflow} pixels too wide`);
    const charts = await page.locator(".chart svg[role=img]").count();
    assert.ok(charts >= 4);
    const before = await picture(page);
    await slide(page, "Time", 0.5);
    assert.notEqual(await picture(page), before);
    assert.deepEqual(complaints, []);
    await close();
  },

  // Every control has a name, every picture a description.
  async names(browser) {
    const { page, close } = await open(browser, file);
    await drawn(page);
    const nameless = await page.locator("button, input, select, svg[role=img]").evaluateAll((found) => found.filter((one) =>
      !(one.getAttribute("aria-label") || one.textContent.trim() || [...(one.labels ?? [])].some((label) => label.textContent.trim())),
    ).map((one) => one.outerHTML.slice(0, 120)));
    assert.deepEqual(nameless, []);
    await close();
  },

  // Charts, numbers and tables are there without the picture, and the page says what is missing.
  async without_webgl(browser) {
    const { page, complaints, close } = await open(browser, file);
    await page.locator(".stage").first().scrollIntoViewIfNeeded();
    await page.getByText("this browser offers no WebGL").first().waitFor();
    const before = await ring(page);
    await slide(page, "Time", 0.5);
    assert.notDeepEqual(await ring(page), before);
    assert.deepEqual(complaints, []);
    await close();
  },

  // Drawing and ranking of a truss show the same joint, and each other's choice.
  async truss(browser) {
    const { page, complaints, close } = await open(browser, file);
    const part = page.locator(".truss").first(), rows = part.locator(".ranks button"), dots = part.locator("g.joint[data-joint]");
    await part.scrollIntoViewIfNeeded();
    await dots.first().waitFor();
    const chosen = () => part.locator("g.joint.chosen").evaluateAll((found) => found.map((one) => one.dataset.joint));
    const pressed = () => part.locator(".ranks button[aria-pressed=true]").evaluateAll((found) => found.map((one) => one.dataset.joint));
    const told = () => part.locator("p.told").textContent();
    assert.ok((await rows.count()) >= 8 && (await rows.count()) <= 15);
    assert.deepEqual([await chosen(), await pressed()], [[], []]);

    await rows.nth(2).click();
    const third = await rows.nth(2).getAttribute("data-joint");
    assert.deepEqual([await chosen(), await pressed()], [[third], [third]], "a chosen row shows its joint");
    const name = await rows.nth(2).locator(".rank-name").textContent();
    assert.ok((await told()).startsWith(`${name}, `) && /rank 3 of \d+: contribution .* jump of the joint .* heat /.test(await told()), await told());
    assert.ok(await part.locator("g.joint.chosen").getByText(name, { exact: true }).count(), "its name stands in the drawing");

    const first = await rows.first().getAttribute("data-joint");
    await part.locator(`g.joint[data-joint="${first}"] .hit`).dispatchEvent("click");
    assert.deepEqual([await chosen(), await pressed()], [[first], [first]], "a chosen joint shows its row");
    await rows.nth(3).hover();
    assert.match(await told(), /rank 4 of/, "pointing tells the numbers");
    assert.deepEqual(await chosen(), [first], "and chooses nothing");
    await rows.first().click();
    assert.deepEqual(await chosen(), [], "choosing again lets go");

    // All of it by keys.
    await part.locator(".truss-drawing").focus();
    await page.keyboard.press("ArrowRight");
    await page.keyboard.press("ArrowRight");
    assert.deepEqual(await chosen(), [await rows.nth(1).getAttribute("data-joint")]);
    await page.keyboard.press("Escape");
    assert.deepEqual(await chosen(), []);
    await rows.nth(4).focus();
    assert.match(await told(), /rank 5 of/, "the focus tells the numbers");
    await page.keyboard.press("Enter");
    assert.deepEqual(await chosen(), [await rows.nth(4).getAttribute("data-joint")]);

    // Jumps are drawn as large as the slider says: twice the magnification, arrows twice as long.
    const moved = () => part.locator(".truss-drawing .moved").last().getAttribute("d");
    const times = () => part.locator(".truss-drawing").evaluate((holder) => Number(holder.dataset.magnification));
    const slider = part.getByLabel("Magnification of the jumps");
    const before = await moved(), factor = await times();
    await slider.press("ArrowRight");
    assert.ok((await times()) >= 2 * factor && (await moved()) !== before, "the slider magnifies the jumps");
    assert.match(await part.locator(".truss-figure").textContent(), new RegExp(`${String(await times()).replace(/\B(?=(\d{3})+$)/g, "\u202f")} times as large`));
    await slider.press("Home");
    assert.equal(await times(), 1);
    const asBuilt = await part.locator(".truss-drawing .as-built").getAttribute("d");
    const places = (path) => path.match(/-?[\d.]+/g).map(Number);
    const links = places(await moved());
    assert.deepEqual(places(asBuilt).slice(0, links.length), links, "jumps of micrometres cannot be seen as they are");
    await part.locator(".truss-drawing").focus();
    await page.keyboard.press("+");
    assert.equal(await times(), 2);

    const ranked = () => rows.evaluateAll((found) => found.map((one) => one.dataset.joint).join(" "));
    const byContribution = await ranked();
    await part.getByLabel("Joints ranked by").selectOption("heat");
    assert.notEqual(await ranked(), byContribution);
    assert.match(await part.textContent(), /not what holds the jump/);
    assert.deepEqual(complaints, []);
    await close();
  },

  async truss_in_space(browser) {
    const { page, complaints, close } = await open(browser, file);
    const part = page.locator(".truss").first();
    await part.scrollIntoViewIfNeeded();
    await part.locator("g.joint").first().waitFor();
    const seen = new Set();
    for (const view of ["oblique", "xy", "xz", "yz"]) {
      await part.getByLabel("View").selectOption(view);
      seen.add(await part.locator(".truss-drawing .moved").last().getAttribute("d"));
    }
    assert.equal(seen.size, 4, "every view is another one");
    // Labels of the replay do not cover each other.
    await drawn(page);
    await picture(page);
    const tags = await page.locator(".stage .tag").evaluateAll((found) => found.filter((one) => one.offsetWidth).map((one) => one.getBoundingClientRect()).map(({ left, right, top, bottom }) => ({ left, right, top, bottom })));
    assert.ok(tags.length >= 3);
    tags.forEach((one, i) => tags.slice(0, i).forEach((other) => assert.ok(
      one.right <= other.left || other.right <= one.left || one.bottom <= other.top + 1 || other.bottom <= one.top + 1, "labels overlap")));
    assert.deepEqual(complaints, []);
    await close();
  },

  async several(browser) {
    const { page, complaints, close } = await open(browser, file);
    await drawn(page);
    assert.equal(await page.locator(".player").count(), 2);
    await page.locator(".stage").nth(1).scrollIntoViewIfNeeded();
    await page.waitForFunction(() => Number(document.querySelectorAll(".stage")[1].dataset.frames ?? 0) > 0);
    await slide(page, "Time", 0.5);
    const times = await page.locator(".player").evaluateAll((players) => players.map((player) => player.dataset.time));
    assert.deepEqual(times, ["0.5", "0"], "each replay has its own time");
    assert.deepEqual(complaints, []);
    await close();
  },
};

const browser = await launch(!checks.includes("without_webgl"));
try {
  for (const check of checks) {
    console.log(`check: ${check}`);
    await CHECKS[check](browser);
  }
} finally {
  await browser.close();
}
