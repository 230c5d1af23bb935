"use strict";
// Colours are named once, in the style sheet; whoever draws asks here and redraws on a change.
const theme = {
  listeners: [],
  colour(name) {
    return getComputedStyle(document.documentElement).getPropertyValue(name).trim();
  },
  resolve(node) {
    if (typeof node === "string") {
      const found = /^var\((--[\w-]+)\)$/.exec(node);
      return found ? theme.colour(found[1]) : node;
    }
    if (Array.isArray(node)) return node.map(theme.resolve);
    if (node && typeof node === "object" && !ArrayBuffer.isView(node)) {
      return Object.fromEntries(Object.entries(node).map(([k, v]) => [k, theme.resolve(v)]));
    }
    return node;
  },
  changed() {
    theme.listeners.forEach((listener) => listener());
  },
};
matchMedia("(prefers-color-scheme: dark)").addEventListener("change", theme.changed);
