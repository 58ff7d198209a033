// What the whole page shares: its data, making elements, the theme, copying and saving.
"use strict";

const DATA = JSON.parse(document.getElementById("data").textContent);
const STORY = DATA.story;
const CALM = matchMedia("(prefers-reduced-motion: reduce)");

function fill(node, attributes, children) {
  for (const [name, value] of Object.entries(attributes)) {
    if (name.startsWith("on")) node.addEventListener(name.slice(2), value);
    else if (value !== null && value !== undefined) node.setAttribute(name, value);
  }
  node.append(...children.filter((child) => child !== null));
  return node;
}

// Text only ever becomes text: nothing here reads markup.
const html = (name, attributes = {}, ...children) => fill(document.createElement(name), attributes, children);
const svg = (name, attributes = {}, ...children) =>
  fill(document.createElementNS("http://www.w3.org/2000/svg", name), attributes, children);

// A long name may go on in the next line behind a word of it; as names.py does.
const breakable = (text) => html("span", {}, ...text.split(/(?<=[^\W_]{3}[_./=-])(?=[^\W\d])/).flatMap((part, i) => (i ? [html("wbr"), part] : [part])));

function button(words, pressed, attributes = {}) {
  return html("button", { type: "button", class: "quiet", onclick: pressed, ...attributes }, words);
}

function isDark() {
  const chosen = document.documentElement.dataset.theme;
  return chosen ? chosen === "dark" : matchMedia("(prefers-color-scheme: dark)").matches;
}

const theme = document.getElementById("theme");
const nameTheme = () => { theme.textContent = isDark() ? "Light" : "Dark"; };
theme.addEventListener("click", () => {
  document.documentElement.dataset.theme = isDark() ? "light" : "dark";
  nameTheme();
});
nameTheme();

function select(node) {
  const range = document.createRange();
  range.selectNodeContents(node);
  getSelection().removeAllRanges();
  getSelection().addRange(range);
}

for (const copy of document.querySelectorAll("[data-copy]")) {
  copy.addEventListener("click", async () => {
    const source = document.getElementById(copy.dataset.copy);
    try {
      await navigator.clipboard.writeText(source.textContent);
      copy.textContent = "Copied";
    } catch {
      select(source);
      copy.textContent = "Selected";
    }
    setTimeout(() => { copy.textContent = "Copy"; }, 2000);
  });
}

for (const save of document.querySelectorAll("[data-save]")) {
  save.addEventListener("click", () => {
    const text = document.getElementById(save.dataset.save).textContent;
    const address = URL.createObjectURL(new Blob([text], { type: "application/yaml" }));
    html("a", { href: address, download: save.dataset.file }).click();
    setTimeout(() => URL.revokeObjectURL(address), 1000);
  });
}
