"""Style: the look of a report, for phones, projectors, paper, by day and by night."""

CSS = """
:root {
  color-scheme: light dark;
  --paper: #fdfdfb; --card: #ffffff; --ink: #1d2330; --soft: #5c6475; --line: #e2e3de;
  --accent: #1f5fa8; --good: #1c7a43; --bad: #b3261e; --unsure: #8a6100;
}
@media (prefers-color-scheme: dark) {
  :root {
    --paper: #14171d; --card: #1b1f27; --ink: #e7e9ee; --soft: #9ca5b6; --line: #2d333f;
    --accent: #82b4f0; --good: #6fce97; --bad: #ff8f86; --unsure: #e5bd62;
  }
}
* { box-sizing: border-box; }
html { font-size: clamp(16px, 0.55vw + 12.5px, 26px); scroll-behavior: smooth; }
body {
  margin: 0; background: var(--paper); color: var(--ink); line-height: 1.55;
  font-family: "Source Sans 3", "Segoe UI", system-ui, -apple-system, "Noto Sans", sans-serif;
}
main, header, footer { max-width: 62rem; margin: 0 auto; padding: 0 1.1rem; }
header { padding-top: 2.4rem; }
h1 { font-size: 1.9rem; line-height: 1.2; margin: 0 0 0.4rem; letter-spacing: -0.01em; }
h2 {
  font-size: 1.3rem; margin: 2.6rem 0 0.8rem; padding-bottom: 0.3rem;
  border-bottom: 2px solid var(--line);
}
h3 { font-size: 1rem; margin: 0; }
p { margin: 0.3rem 0 0.8rem; }
a { color: var(--accent); text-decoration: none; }
a:hover { text-decoration: underline; }
.name { color: var(--soft); font-size: 0.95rem; margin: 0; letter-spacing: 0.04em; }
.story { font-size: 1.12rem; max-width: 46rem; white-space: pre-line; }
nav { margin: 1.1rem 0 0; display: flex; flex-wrap: wrap; gap: 0.4rem 0.5rem; }
nav a {
  border: 1px solid var(--line); border-radius: 2rem; padding: 0.1rem 0.8rem;
  background: var(--card);
}
dl.facts {
  display: grid; grid-template-columns: max-content 1fr; gap: 0.25rem 1.2rem; margin: 1rem 0;
}
dl.facts dt { color: var(--soft); }
dl.facts dd { margin: 0; min-width: 0; overflow-wrap: anywhere; }
.card {
  background: var(--card); border: 1px solid var(--line); border-radius: 0.7rem;
  padding: 0.8rem 1rem; margin: 0 0 0.9rem;
}
.head { display: flex; flex-wrap: wrap; align-items: baseline; gap: 0.2rem 1.2rem; }
.head math, .note { color: var(--soft); }
.note { font-size: 0.88rem; margin: 0.5rem 0 0; }
.scroll { overflow-x: auto; overflow-y: hidden; padding: 0.5rem 0 0.3rem; }
.components {
  display: grid; gap: 0.2rem 1.6rem; padding-top: 0.4rem;
  grid-template-columns: repeat(3, minmax(0, 1fr));
}
.components.two { grid-template-columns: repeat(2, minmax(0, 1fr)); }
.components > .scroll { padding: 0.35rem 0; }
.components > .wide { grid-column: 1 / -1; }
.card.scroll { padding: 0.8rem 1rem; }
small { color: var(--soft); padding-left: 0.6rem; }
.figure {
  display: block; max-width: 100%; height: auto; margin: 0.8rem auto;
  background: #ffffff; border-radius: 0.5rem;
}
.zero { color: var(--soft); }
math { font-size: 1.12em; font-family: "Latin Modern Math", "STIX Two Math", "Cambria Math", math; }
math[display="block"] { margin: 0; text-align: left; width: max-content; }
mtable { math-style: normal; }
mtd { padding: 0.35em 0.6em; }
summary { cursor: pointer; color: var(--accent); padding-top: 0.5rem; }
table { border-collapse: collapse; width: 100%; }
caption { text-align: left; font-weight: 600; padding: 0.2rem 0 0.4rem; }
tr + tr td { border-top: 1px solid var(--line); }
td { padding: 0.35rem 0.8rem 0.35rem 0; vertical-align: baseline; }
td:first-child { width: 1.6rem; font-weight: 700; }
td:nth-child(2) { white-space: nowrap; }
td:last-child { padding-right: 0; }
.good { color: var(--good); } .bad { color: var(--bad); } .unsure { color: var(--unsure); }
footer { color: var(--soft); font-size: 0.88rem; padding-top: 1.5rem; padding-bottom: 3rem; }
@media (max-width: 40rem) {
  html { font-size: 16px; }
  h1 { font-size: 1.5rem; }
  .card { padding: 0.7rem 0.8rem; }
  dl.facts { grid-template-columns: 1fr; gap: 0; }
  dl.facts dd { margin-bottom: 0.5rem; }
  td:nth-child(2) { white-space: normal; }
  .components, .components.two { grid-template-columns: minmax(0, 1fr); }
}
@media print {
  html { font-size: 10.5pt; }
  nav { display: none; }
  .card { break-inside: avoid; border-color: #bbb; }
  .scroll { overflow: visible; }
}
"""
