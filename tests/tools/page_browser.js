// SPDX-License-Identifier: Apache-2.0
// page_browser.js REPORT SUMMARY: the page of a run in headless Chromium (playwright-core, axe-core from NODE_PATH):
// it shows the summary's values and the surfaces beside SUMMARY, with no error, no request, working keys and no
// finding of axe-core, wide and phone-sized, light and dark. 77 without those packages. Prints the times to open and
// to draw.
'use strict';
const fs = require('fs');
let chromium, axe;
try {
  ({chromium} = require('playwright-core'));
  axe = require.resolve('axe-core/axe.min.js');
} catch (e) {
  process.exit(77);
}
const browser_file = ['/usr/bin/chromium', '/usr/bin/google-chrome'].find(file => fs.existsSync(file));
if (!browser_file) process.exit(77);

(async () => {
  const summary = JSON.parse(fs.readFileSync(process.argv[3]));
  const browser = await chromium.launch({executablePath: browser_file, args: ['--no-sandbox']});
  const page = await browser.newPage({viewport: {width: 1280, height: 900}}), failures = [], requests = [];
  const check = (good, what) => { if (!good) failures.push(what); };
  page.on('console', m => { if (m.type() === 'error') failures.push(m.text()); });
  page.on('pageerror', e => failures.push(String(e)));
  page.on('request', r => { if (!r.url().startsWith('data:')) requests.push(r.url()); });
  const begin = Date.now();
  await page.goto('file://' + require('path').resolve(process.argv[2]));
  await page.evaluate(() => new Promise(done => requestAnimationFrame(() => requestAnimationFrame(done))));
  const opened_ms = Date.now() - begin;

  const figures = await page.$$eval('#details tr', rows => Object.fromEntries(rows.map(row => [...row.children].map(cell => cell.textContent))));
  check(figures.Distance === summary.distance_m.toFixed(2) + ' m', `distance ${figures.Distance}, in the summary ${summary.distance_m}`);
  check(figures.Steps === String(summary.steps), `steps ${figures.Steps}, in the summary ${summary.steps}`);
  check(figures['Camera frames'] === String(summary.frames), `frames ${figures['Camera frames']}, in the summary ${summary.frames}`);
  check(requests.length === 1, `asks for ${requests.slice(1)}`);

  const cursor = () => page.$eval('#cursor', e => Number(e.value));
  await page.keyboard.press('Home');
  const first = await cursor();
  await page.keyboard.press('ArrowRight');
  await page.waitForFunction(t => Number(document.getElementById('cursor').value) > t, first, {timeout: 5000}).catch(() => failures.push('the right arrow moves nothing'));
  const draw = await page.evaluate(() => {
    const cost = [];
    for (let k = 0; k < 50; ++k) {
      view.now = view.whole[0] + (view.whole[1] - view.whole[0]) * k / 50;
      const start = performance.now();
      view.listeners.forEach(listener => listener());
      cost.push(performance.now() - start);
    }
    return cost.sort((a, b) => a - b)[25];
  });

  // Landmarks and surfaces: drawn, turned by the keyboard without moving the time, and there as text.
  const surfaces = JSON.parse(fs.readFileSync(require('path').join(require('path').dirname(process.argv[3]), 'surfaces.json')));
  const look = () => page.evaluate(() => { redraw(); view.listeners.forEach(listener => listener()); return document.getElementById('map').toDataURL(); });
  await page.click('#map-tilt');
  const track = await look();
  await page.click('#map-scene');
  const scene = await look(), before_turn = await cursor();
  check(track !== scene, 'landmarks and surfaces are not drawn');
  await page.focus('#map');
  await page.keyboard.press('ArrowLeft');
  check(await look() !== scene, 'the left arrow does not turn the focused track');
  check(await cursor() === before_turn, 'the left arrow on the track moves the time');
  const rows = await page.$$eval('#details tr', all => all.map(row => row.children[0].textContent));
  check(surfaces.length > 0 && surfaces.every(s => rows.filter(kind => kind === s.kind).length === surfaces.filter(t => t.kind === s.kind).length),
        `surfaces in the table: ${rows}; in the run: ${surfaces.map(s => s.kind)}`);
  check(/\d+ landmarks, 1 floor/.test(await page.getAttribute('#map', 'aria-label')), 'the label of the track does not state what it shows');

  await page.addScriptTag({path: axe});
  for (const [width, colorScheme] of [[1280, 'light'], [1280, 'dark'], [390, 'light']]) {
    await page.setViewportSize({width, height: 844});
    await page.emulateMedia({colorScheme});
    const {violations} = await page.evaluate(() => axe.run());
    violations.forEach(v => failures.push(`axe-core, ${width} px, ${colorScheme}: ${v.id} at ${v.nodes.map(n => n.target)}`));
    check(await page.evaluate(() => document.documentElement.scrollWidth <= innerWidth), `wider than ${width} px`);
  }
  await browser.close();
  console.log(`the page opened in ${opened_ms} ms and draws a moment in ${draw.toFixed(1)} ms (median)`);
  failures.forEach(text => console.log('FAILED:', text));
  process.exit(failures.length ? 1 : 0);
})();
