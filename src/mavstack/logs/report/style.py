"""The style sheet of reports: light and dark, desktop and phone."""

from __future__ import annotations

from typing import Final

STYLE: Final = """\
:root{color-scheme:light dark;--bg:#fff;--fg:#1b1f24;--dim:#5b6570;--card:#f4f6f8;--line:#d5dbe1;
--c0:#1667c1;--c1:#c2410c;--c2:#15803d;--c3:#7e22ce;--c4:#a16207;--c5:#be185d;
--critical:#b91c1c;--warning:#b45309;--info:#1667c1;--b0:#eef2f6;--b1:#e3e9ef}
@media (prefers-color-scheme:dark){:root{--bg:#14181d;--fg:#e6eaef;--dim:#9aa6b2;
--card:#1d232a;--line:#35404b;
--c0:#5aa9f8;--c1:#fb923c;--c2:#4ade80;--c3:#c084fc;--c4:#facc15;--c5:#f472b6;
--critical:#f87171;--warning:#fbbf24;--info:#5aa9f8;--b0:#1a2027;--b1:#222a33}}
*{box-sizing:border-box}body{margin:0;background:var(--bg);color:var(--fg);
font:15px/1.5 system-ui,-apple-system,"Segoe UI",Roboto,sans-serif}
main{max-width:940px;margin:0 auto;padding:1rem}h1{font-size:1.5rem;margin:.4rem 0;overflow-wrap:anywhere}
h2{font-size:1.15rem;margin:1.8rem 0 .6rem;border-bottom:1px solid var(--line);padding-bottom:.2rem}
p{margin:.3rem 0}.dim,small{color:var(--dim);font-weight:normal}
.cards{display:grid;margin-top:.8rem;grid-template-columns:repeat(auto-fill,minmax(140px,1fr));gap:.6rem}
.card{background:var(--card);border-radius:8px;padding:.5rem .8rem;overflow-wrap:anywhere}
.card b{display:block;font-size:1.1rem}.card span{color:var(--dim);font-size:.85rem}
.finding{border-left:4px solid;background:var(--card);border-radius:6px;padding:.5rem .8rem;margin:.5rem 0}
.finding b{display:block}.critical{border-color:var(--critical)}.warning{border-color:var(--warning)}
.info{border-color:var(--info)}figure{margin:1rem 0}figcaption{font-weight:600;margin-bottom:.2rem}
svg{width:100%;height:auto;display:block;background:var(--card);border-radius:8px}
svg.map{max-width:460px;margin:0 auto}svg text{fill:var(--dim);font-size:11px}svg text.y{text-anchor:end}
svg text.x{text-anchor:middle}
svg text.band{font-size:10px;paint-order:stroke;stroke:var(--b0);stroke-width:3px}
.grid{stroke:var(--line);stroke-width:1}
.axis{stroke:var(--fg);stroke-width:2}.line{fill:none;stroke-width:1.5;stroke-linejoin:round}
.line.c0{stroke:var(--c0)}.line.c1{stroke:var(--c1)}.line.c2{stroke:var(--c2)}.line.c3{stroke:var(--c3)}
.line.c4{stroke:var(--c4)}.line.c5{stroke:var(--c5)}.key{font-weight:normal;margin-left:.9rem;font-size:.85rem}
.key::before{content:"";display:inline-block;width:.9rem;height:3px;margin-right:.3rem;vertical-align:middle}
.key.c0::before{background:var(--c0)}.key.c1::before{background:var(--c1)}.key.c2::before{background:var(--c2)}
.key.c3::before{background:var(--c3)}.key.c4::before{background:var(--c4)}.key.c5::before{background:var(--c5)}
.band.b0{fill:var(--b0)}.band.b1{fill:var(--b1)}path.mark{stroke:var(--critical);stroke-dasharray:3 3}
circle.mark{fill:none;stroke:var(--critical);stroke-width:2}.start{fill:var(--c2)}.end{fill:var(--critical)}
svg text.title{font-size:13px;font-weight:600;fill:var(--fg)}
table{border-collapse:collapse;width:100%;font-size:.9rem}td,th{text-align:left;padding:.15rem .6rem .15rem 0;
border-bottom:1px solid var(--line);vertical-align:top}
td:first-child,td:last-child{overflow-wrap:anywhere}
td.n,th.n{text-align:right;width:6.5rem;white-space:nowrap;font-variant-numeric:tabular-nums}
details{margin:.6rem 0}summary{cursor:pointer;font-weight:600}
/* On a phone a chart is less than half as wide: larger texts, and every other number. */
@media (max-width:600px){figure svg{overflow:visible}figure text{font-size:24px}
figure text.minor,figure text.band{display:none}td.n,th.n{width:auto}
figure text.y{text-anchor:start;transform:translateX(-42px)}figure .line{stroke-width:2.6}
figure text.x,figure text.y{paint-order:stroke;stroke:var(--card);stroke-width:6px}}
/* The tools of the script: cursor, zoom and own fields. */
#tools{position:sticky;top:0;z-index:1}svg.shapes{position:absolute;width:0;height:0}.tools{display:flex;flex-wrap:wrap;gap:.4rem;align-items:center;
background:var(--bg);border-bottom:1px solid var(--line);padding:.4rem 0}
.tools input{flex:1;min-width:8rem}.tools output{flex-basis:100%;color:var(--dim);font-size:.85rem;
white-space:nowrap;overflow:hidden;text-overflow:ellipsis}
button,input[type=search]{font:inherit;color:var(--fg);background:var(--card);border:1px solid var(--line);
border-radius:6px;padding:.15rem .6rem;min-width:2.2rem}svg.live{touch-action:pan-y;cursor:crosshair}
path.cursor{stroke:var(--fg);stroke-width:1}circle.cursor{fill:none;stroke:var(--fg);stroke-width:3}
path.event{stroke:var(--dim)}rect.selection{fill:var(--c0);opacity:.25}.value{font-variant-numeric:tabular-nums}
.tree{max-height:22rem;overflow:auto;margin:.4rem 0}.tree details{margin:.1rem 0}
.tree label{display:inline-block;margin:0 1rem .2rem 0}.tree [hidden]{display:none}
@media print{details{display:block}.tools,#fields{display:none}}
"""
