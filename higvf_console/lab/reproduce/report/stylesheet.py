"""The style sheet of the page: one text column with contents beside it, light, dark and print."""

SHEET = """
:root { color-scheme: light dark; --ink: #1f2328; --quiet: #59636e; --page: #ffffff; --line: #d9dee4; --soft: #f5f7f9;
  --link: #005a8f; --met: #00734f; --missed: #b34700; }
@media (prefers-color-scheme: dark) { :root { --ink: #e4e7eb; --quiet: #9aa5b1; --page: #14171b; --line: #30363d;
  --soft: #1c2127; --link: #6cb8ea; --met: #3fc79a; --missed: #ff9b54; } }
* { box-sizing: border-box; }
html { scroll-padding-top: 1rem; }
body { margin: 0; background: var(--page); color: var(--ink);
  font: 16px/1.6 system-ui, -apple-system, "Segoe UI", Roboto, "Helvetica Neue", Arial, sans-serif; }
main { max-width: 54rem; margin: 0 auto; padding: 2.5rem 1.5rem 6rem; }
h1 { font-size: 2rem; line-height: 1.2; margin: 0 0 .6rem; }
h2 { font-size: 1.35rem; line-height: 1.3; margin: 3.2rem 0 .8rem; padding-top: 1.2rem;
  border-top: 1px solid var(--line); }
h2 code { font-size: .8rem; font-weight: 400; color: var(--quiet); margin-left: .4rem; }
h3 { font-size: 1rem; margin: 1.6rem 0 .4rem; }
p { margin: .5rem 0; } a { color: var(--link); }
.lead { font-size: 1.1rem; } .made, figcaption, .note { color: var(--quiet); font-size: .88rem; }
.note { border-left: 3px solid var(--line); padding-left: .8rem; }
code { font: .86em/1.4 ui-monospace, SFMono-Regular, Menlo, Consolas, monospace; }
.digest { font-size: .68rem; overflow-wrap: anywhere; }
.scroll { overflow-x: auto; margin: .8rem 0 1.2rem; }
table { border-collapse: collapse; width: 100%; font-size: .88rem; line-height: 1.4; }
th, td { text-align: left; vertical-align: top; padding: .35rem .6rem; border-bottom: 1px solid var(--line); }
th { font-weight: 600; color: var(--quiet); } .number { text-align: right; white-space: nowrap;
  font-variant-numeric: tabular-nums; }
td.met { color: var(--met); font-weight: 700; white-space: nowrap; }
td.missed { color: var(--missed); font-weight: 700; white-space: nowrap; } td.open { color: var(--quiet); }
figure { margin: 1.6rem 0; } figure img { display: block; max-width: 100%; height: auto; margin: 0 auto;
  background: #fff; border: 1px solid var(--line); border-radius: 6px; padding: .6rem; }
figcaption { margin-top: .5rem; } dt { font-weight: 600; margin-top: .8rem; }
dd { margin: 0 0 .4rem; color: var(--quiet); }
nav { font-size: .88rem; line-height: 1.45; max-width: 54rem; margin: 0 auto; padding: 1.5rem 1.5rem 0; }
nav p { font-weight: 600; color: var(--quiet); margin: 0 0 .3rem; } nav ol { margin: 0; padding-left: 1.3rem; }
nav a { text-decoration: none; } nav a:hover { text-decoration: underline; }
@media (min-width: 84rem) {
  nav { position: fixed; top: 0; bottom: 0; left: 0; width: 17rem; overflow-y: auto; padding: 2.7rem 1.2rem;
    border-right: 1px solid var(--line); background: var(--soft); }
  main { margin-left: max(19rem, calc(50vw - 22rem)); }
}
@media print { nav { display: none; } main { max-width: none; padding: 0; } figure, tr { break-inside: avoid; } }
"""
