"""The style sheet of the printed page: A4, millimetres, and nothing that needs colour to be read."""

from typing import Final

STYLE: Final = """
@page { size: A4; margin: 11mm 12mm 12mm }
* { box-sizing: border-box }
html { color: #111; background: #fff; font: 9.5pt/1.3 "Segoe UI", "Helvetica Neue", Roboto, Arial, "Noto Sans", "Noto Sans SC",
  "PingFang SC", "Microsoft YaHei", "WenQuanYi Zen Hei", "DejaVu Sans Condensed", system-ui, sans-serif;
  -webkit-print-color-adjust: exact; print-color-adjust: exact }
body { width: 186mm; margin: 0 auto }
svg { display: block; overflow: visible }
section + section { break-before: page }
h1 { font-size: 17pt; line-height: 1.15; margin: 0 }
h2 { font-size: 12.5pt; margin: 3mm 0 1mm }
article h2 { margin: 0 }
.facts { margin: .5mm 0 0; color: #333 }
.lesson { border-bottom: .6mm solid #111; padding-bottom: 2mm }
table { border-collapse: collapse; width: 100%; margin: 1mm 0 }
th { text-align: left; font-weight: 600; font-size: 8.5pt; color: #333; border-bottom: .3mm solid #111; padding: .6mm 3mm .6mm 0 }
td { border-bottom: .2mm solid #bbb; padding: .9mm 3mm .9mm 0; vertical-align: top }
td:first-child { white-space: nowrap }
.number { text-align: right; white-space: nowrap }
.key { display: inline-block; width: 4.2mm; height: 4.2mm; line-height: 4mm; text-align: center; border: .3mm solid #111;
  border-radius: 50%; font-size: 7.5pt; font-weight: 700; margin-right: 1.5mm }
.notes { font-size: 8pt; color: #333; margin: 1.5mm 0 0 }
article { break-inside: avoid; border-top: .6mm solid #111; padding-top: 1.6mm; margin-top: 4mm }
.head { display: flex; align-items: baseline; gap: 3mm }
.head .facts { flex: 1; margin: 0 }
.points { font-size: 9.5pt; white-space: nowrap }
.points b { font-size: 17pt; line-height: 1 }
.said { display: flex; gap: 6mm; margin: .5mm 0 0 }
.said p { margin: 0; flex: 1 1 0 }
.said b { display: block; font-size: 8.5pt; font-weight: 600; color: #333 }
.said span { font-size: 11.5pt; line-height: 1.2 }
.said .next { flex: 1.5 1 0; border-left: 1.4mm solid #111; padding-left: 2.2mm }
.said .next span { font-weight: 700 }
.said .silent { border-left-color: #bbb; align-self: center }
.said .silent span { font-weight: 400 }
.below { display: flex; gap: 3.5mm; align-items: flex-start; margin-top: .5mm }
.measures { flex: 1; list-style: none; margin: 0; padding: 0 }
.measures li { padding: 0 0 1.2mm; margin: 0 0 1.2mm; border-bottom: .2mm solid #bbb; line-height: 1.2 }
.measures li:last-child { border: 0 }
.measures .what { display: block; font-size: 8.5pt }
.measures .value { font-size: 11.5pt; font-weight: 700; white-space: nowrap }
.measures .verdict { white-space: nowrap }
.measures .range { display: block; font-size: 8pt; color: #333 }
.unknown { color: #6b6b6b; font-weight: 400 !important }
figure { margin: 0 }
figcaption { font-size: 7.5pt; line-height: 1.15; color: #333 }
figure.curve { width: 66mm }
figure.curve .name { font-size: 8pt; font-weight: 600; color: #111 }
.legend { display: flex; flex-wrap: wrap; gap: 0 4mm; font-size: 8pt; color: #333; margin: 0 }
.legend svg { display: inline-block; width: 5mm; height: 2.6mm; vertical-align: -.3mm; margin-right: 1mm }
.floor { stroke: #111; stroke-width: .3 }
.shadow { fill: #b9c4d0 }
.edge { stroke: #111; stroke-width: .25; stroke-linejoin: round; stroke-linecap: round }
.good { fill: #e3f4e2 }
.near { fill: #ffd84d }
.off { fill: #d4351c }
.dots { stroke: #4a3500; stroke-width: .44; stroke-linecap: round; stroke-dasharray: 0 .78 }
.stripes { stroke: #3d0a03; stroke-width: .5 }
.unsure { fill: #fff; stroke: #777; stroke-dasharray: .7 .5 }
.nose { fill: #111 }
.lost { font-size: 9px; fill: #777; font-weight: 700 }
.lost.small { font-size: 4px }
.phase { font-size: 3.5px; font-weight: 600 }
.when { font-size: 2.9px; fill: #333 }
.when.vague { fill: #6b6b6b }
.grid { stroke: #ddd; stroke-width: .15 }
.axis { stroke: #111; stroke-width: .2 }
.tick { font-size: 2.5px; fill: #333 }
.mark { font-size: 2.7px; font-weight: 700 }
.keyframe { stroke: #111; stroke-width: .2; stroke-dasharray: .8 .6 }
.band { fill: #d9d9d9 }
.model { fill: none; stroke: #777; stroke-width: .3; stroke-dasharray: 1.2 .7 }
.pupil { fill: none; stroke: #111; stroke-width: .7; stroke-linejoin: round; stroke-linecap: round }
.gap { fill: #fff }
.lines { stroke: #b5b5b5; stroke-width: .25 }
.whisker { stroke: #111; stroke-width: .35 }
.score { fill: #fff; stroke: #111; stroke-width: .35 }
.letter { font-size: 2.4px; font-weight: 700 }
@media screen { html { background: #e8e8e8 } body { background: #fff; padding: 12mm; width: 210mm; margin: 4mm auto } }
"""
