// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace dseam::program {

/// The style sheet of report.html: no font, script or picture from elsewhere; prints well.
inline constexpr const char* kPageStyle = R"css(
:root{--ink:#1f2933;--soft:#66727e;--rule:#e2e6ea;--paper:#fff;--ground:#f4f5f3;--good:#1b7f4d;
--bad:#b3261e;--shell:#4a7ba6;--nozzle:#c07a2b}
*{box-sizing:border-box}
body{margin:0;background:var(--ground);color:var(--ink);font:15px/1.5 system-ui,"Segoe UI",
"DejaVu Sans",sans-serif}
main{max-width:1180px;margin:0 auto;padding:28px 24px 60px}
header{display:flex;justify-content:space-between;align-items:baseline;flex-wrap:wrap;gap:8px}
h1{font-size:22px;margin:0}h2{font-size:17px;margin:34px 0 10px}
.soft{color:var(--soft)}
.verdict{border-radius:10px;color:#fff;padding:16px 20px;margin:14px 0 18px;background:var(--bad)}
.verdict.good{background:var(--good)}
.verdict b{font-size:20px;display:block}
.tiles{display:grid;grid-template-columns:repeat(auto-fit,minmax(128px,1fr));gap:12px}
.tile,figure,.card{background:var(--paper);border:1px solid var(--rule);border-radius:10px}
.tile{padding:12px 14px}.tile b{display:block;white-space:nowrap;font-size:19px;font-weight:600}
.tile span{color:var(--soft);font-size:13px}
.pictures{display:grid;grid-template-columns:2fr 1fr;gap:14px}
.pictures figure:first-child{grid-row:span 2;align-self:start}
figure{margin:0;padding:10px;overflow:hidden}figcaption{color:var(--soft);font-size:13px;
padding:2px 4px 0}
svg{display:block;width:100%;height:auto}
svg text{font:12px system-ui,"DejaVu Sans",sans-serif;fill:var(--soft)}
.seam{fill:none;stroke:#00b894;stroke-width:3.2;stroke-linejoin:round;stroke-linecap:round}
.seam.bridged{stroke:#e84393;stroke-dasharray:7 6}
.seam.hidden{stroke-width:1.8;stroke-opacity:.75;stroke-dasharray:2 5}
.travel{fill:none;stroke:#2d3436;stroke-width:1.4;stroke-dasharray:5 4}
.travel.hidden{stroke-opacity:.35}
.start{fill:#fff;stroke:#00876c;stroke-width:2.6}
.scale{stroke:var(--ink);stroke-width:3;fill:none}
.chart .grid{stroke:var(--rule);fill:none}.chart .gap{fill:#fdeaf3}
.chart .line{fill:none;stroke-width:1.8;stroke-linejoin:round}.chart .band{fill-opacity:.16}
.charts{display:grid;grid-template-columns:1fr 1fr;gap:14px}
.card{padding:14px 16px;overflow-x:auto}
table{border-collapse:collapse;width:100%;font-size:14px}
th{color:var(--soft);font-weight:500;text-align:left}th,td:first-child{white-space:nowrap}
th,td{padding:4px 12px 4px 0;border-bottom:1px solid var(--rule);vertical-align:top}
td.n,th.n{text-align:right;font-variant-numeric:tabular-nums}
td.bar{width:34%;vertical-align:middle;padding-right:16px}td.bar i{display:block;height:10px;border-radius:3px;background:var(--shell)}
tr.total td{font-weight:600;border-bottom:0}
.key i{display:inline-block;width:22px;height:0;border-top:3px solid;vertical-align:middle;
margin:0 6px 0 14px}
ul.warnings{margin:0 0 18px;padding:10px 14px 10px 32px;background:#fff7e0;border-radius:10px;
border:1px solid #f0dfae}
@media(max-width:760px){.pictures,.charts{grid-template-columns:1fr}}
@media print{body{background:#fff}main{padding:0}.verdict{-webkit-print-color-adjust:exact;
print-color-adjust:exact}}
)css";

}  // namespace dseam::program
