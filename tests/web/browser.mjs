// SPDX-License-Identifier: GPL-3.0-or-later
// Opens report pages in headless Chromium and takes note of whatever they complain about or ask for.
import { createRequire } from "node:module";
import { pathToFileURL } from "node:url";
import path from "node:path";

// The packages are in the build tree, not beside this file.
const { chromium } = createRequire(path.join(process.env.STATEJUMP_WEB, "package.json"))("playwright-core");

const SOFTWARE = ["--use-angle=swiftshader", "--enable-unsafe-swiftshader"];

/** Returns a browser; without WebGL if asked. */
export function launch(webgl = true) {
  return chromium.launch({
    executablePath: process.env.STATEJUMP_CHROMIUM,
    chromiumSandbox: process.getuid() !== 0, // Chromium's sandbox refuses root
    args: webgl ? SOFTWARE : ["--disable-3d-apis"],
  });
}

export const WIDE = { viewport: { width: 1280, height: 900 } };
export const NARROW = { viewport: { width: 390, height: 844 }, hasTouch: true, isMobile: true, deviceScaleFactor: 2 };

/** Opens a page from the disk; `complaints` fills with console errors, exceptions and requests. */
export async function open(browser, file, options = {}) {
  const context = await browser.newContext({ ...WIDE, ...options });
  const page = await context.newPage();
  const address = pathToFileURL(path.resolve(file)).href;
  const complaints = [];
  page.on("console", (message) => {
    if (message.type() === "error") complaints.push(`console: ${message.text()}`);
  });
  page.on("pageerror", (error) => complaints.push(`exception: ${error.stack}`));
  page.on("request", (request) => {
    const url = request.url();
    if (url !== address && !url.startsWith("data:") && !url.startsWith("blob:")) complaints.push(`request: ${url}`);
  });
  await page.goto(address);
  return { page, complaints, close: () => context.close() };
}

/** Waits until the picture of the first replay has been drawn. */
export async function drawn(page) {
  await page.locator(".stage").first().scrollIntoViewIfNeeded();
  await page.waitForFunction(() => Number(document.querySelector(".stage")?.dataset.frames ?? 0) > 0);
}

/** Moves a slider of the first replay to a fraction of its way. */
export async function slide(page, label, fraction) {
  await page.locator(".player").first().getByLabel(label, { exact: true }).evaluate((input, value) => {
    input.value = String(Number(input.max) * value);
    input.dispatchEvent(new Event("input"));
  }, fraction);
}

/** Returns the picture after two more frames, so that what was asked for is in it. */
export async function picture(page) {
  await page.evaluate(() => new Promise((done) => requestAnimationFrame(() => requestAnimationFrame(() => requestAnimationFrame(done)))));
  return page.locator(".stage canvas").first().evaluate((canvas) => canvas.toDataURL());
}
