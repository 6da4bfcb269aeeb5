// SPDX-License-Identifier: GPL-3.0-or-later
const CHOICES = ["automatic", "light", "dark"] as const;
type Choice = (typeof CHOICES)[number];
const KEY = "statejump-theme";

const listeners: (() => void)[] = [];
const prefersDark = matchMedia("(prefers-color-scheme: dark)");

/** Calls back when the colours of the page have changed. */
export function onTheme(listener: () => void): void {
  listeners.push(listener);
}

/** Returns the value of a custom property of the style, a colour. */
export function colour(name: string): string {
  return getComputedStyle(document.documentElement).getPropertyValue(`--${name}`).trim();
}

function stored(): Choice {
  try {
    return CHOICES.find((choice) => choice === localStorage.getItem(KEY)) ?? "automatic";
  } catch {
    return "automatic"; // storage is refused to some local files
  }
}

export function setUpTheme(): void {
  const button = document.getElementById("theme") as HTMLButtonElement;
  let choice = stored();
  const apply = () => {
    const dark = choice === "dark" || (choice === "automatic" && prefersDark.matches);
    document.documentElement.dataset["theme"] = dark ? "dark" : "light";
    button.textContent = `Theme: ${choice}`;
    for (const listener of listeners) listener();
  };
  button.hidden = false;
  button.addEventListener("click", () => {
    choice = CHOICES[(CHOICES.indexOf(choice) + 1) % CHOICES.length] ?? "automatic";
    try {
      localStorage.setItem(KEY, choice);
    } catch {
      /* then it is for this visit only */
    }
    apply();
  });
  prefersDark.addEventListener("change", apply);
  apply();
}
