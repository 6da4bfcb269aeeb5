// SPDX-License-Identifier: GPL-3.0-or-later
// Pictures of a report page for the documentation: node screenshots.mjs PAGE FOLDER NAME [TIME].
// The narrow one is of the replay, of a truss of its jumps.
import path from "node:path";
import { drawn, launch, NARROW, open, picture, slide } from "./browser.mjs";

const [file, folder, name, time = "0.35"] = process.argv.slice(2);
const browser = await launch();
for (const [kind, options] of [
  ["light", { colorScheme: "light" }], ["dark", { colorScheme: "dark" }], ["narrow", { colorScheme: "light", ...NARROW }],
]) {
  const { page, close } = await open(browser, file, options);
  await drawn(page);
  await slide(page, "Time", Number(time));
  await picture(page);
  const truss = page.locator("section:has(> .truss)");
  if (await truss.count()) {
    await truss.locator(".ranks button").first().click();
    await page.mouse.move(0, 0);
  }
  const target = path.join(folder, `${name}_${kind}.png`);
  if (kind === "narrow") {
    await ((await truss.count()) ? truss : page.locator(".player")).first().screenshot({ path: target });
  } else {
    await page.setViewportSize({ width: 1180, height: 2150 });
    await page.evaluate(() => scrollTo(0, 0));
    await picture(page);
    await page.screenshot({ path: target });
  }
  await close();
}
await browser.close();
