// SPDX-License-Identifier: GPL-3.0-or-later
// Bundles the page's script and style: node build.mjs OUTPUT-FOLDER. Licences of what went into the
// bundle are collected from the packages and must be those in NOTICES.txt; "node build.mjs --notices"
// writes that file.
import { build } from "esbuild";
import { copyFile, mkdir, readFile, readdir, writeFile } from "node:fs/promises";
import path from "node:path";
import { fileURLToPath } from "node:url";

const here = path.dirname(fileURLToPath(import.meta.url));
const notices = path.join(here, "NOTICES.txt");
const writesNotices = process.argv[2] === "--notices";
const output = writesNotices ? null : process.argv[2];
if (!writesNotices && !output) {
  console.error("usage: node build.mjs OUTPUT-FOLDER | --notices");
  process.exit(2);
}

const result = await build({
  absWorkingDir: here,
  entryPoints: { page: "src/main.ts" },
  outdir: output ?? "unused",
  bundle: true,
  minify: true,
  format: "iife",
  target: ["es2020"],
  charset: "utf8",
  legalComments: "none", // the licences stand in the page in full
  metafile: true,
  write: false,
});

// Folder of the package that a bundled file belongs to.
function packageOf(input) {
  const match = /^(.*node_modules\/(?:@[^/]+\/)?[^/]+)\//.exec(input);
  return match ? match[1] : null;
}

const inBundle = Object.values(result.metafile.outputs).flatMap((file) =>
  Object.entries(file.inputs)
    .filter(([, use]) => use.bytesInOutput > 0)
    .map(([input]) => input),
);
const packages = [...new Set(inBundle.map(packageOf).filter(Boolean))].sort();
const parts = [];
for (const folder of packages) {
  const about = JSON.parse(await readFile(path.join(here, folder, "package.json"), "utf8"));
  const file = (await readdir(path.join(here, folder))).find((name) => /^licen[cs]e/i.test(name));
  if (!file) throw new Error(`${about.name}: no licence file`);
  const text = (await readFile(path.join(here, folder, file), "utf8")).trim();
  parts.push(`${about.name} ${about.version} (${about.license})\n\n${text}\n`);
}
const collected = parts.join(`\n${"-".repeat(72)}\n\n`);

if (writesNotices) {
  await writeFile(notices, collected);
} else {
  if ((await readFile(notices, "utf8").catch(() => "")) !== collected) {
    console.error("NOTICES.txt does not name what is in the bundle: run node build.mjs --notices");
    process.exit(1);
  }
  await mkdir(output, { recursive: true });
  for (const file of result.outputFiles) {
    await writeFile(path.join(output, path.basename(file.path)), file.contents);
    console.log(`${path.basename(file.path)}: ${(file.contents.length / 1e3).toFixed(0)} kB`);
  }
  await copyFile(notices, path.join(output, "notices.txt"));
}
