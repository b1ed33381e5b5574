// Looks at the pages of plans in Chromium: see page_check.sh.
//   node page_check.mjs FOLDER-OF-PLANS [FOLDER-FOR-SCREENSHOTS]
import assert from 'node:assert/strict';
import { mkdtempSync, readFileSync, rmSync, statSync, writeFileSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { join } from 'node:path';
import { chromium } from 'playwright-core';

// Screenshots take most of the time: without a folder for them there are none.
const [, , desk, shots] = process.argv;
const QUIET = ['--no-sandbox', '--disable-gpu', '--disable-quic', '--no-first-run', '--disable-background-networking',
  '--disable-component-update', '--disable-sync'];
const WEBGL = ['--use-angle=swiftshader', '--enable-unsafe-swiftshader'];
const PLAIN = ['--disable-3d-apis'];
const file = name => join(desk, name, 'report.html');

async function inBrowser(flags, look) {
  const profile = mkdtempSync(join(tmpdir(), 'profile-'));
  const context = await chromium.launchPersistentContext(profile, {
    executablePath: '/usr/bin/chromium', headless: true, args: [...QUIET, ...flags], viewport: { width: 1280, height: 900 },
  });
  try { await look(context); } finally { await context.close(); rmSync(profile, { recursive: true, force: true }); }
}

// Opens a page that must neither complain nor ask for anything but itself. Other work on the machine may slow it down:
// the quickest of three times counts.
async function open(context, name) {
  let opened = await openOnce(context, name);
  for (let again = 0; again < 2 && opened.took >= 3000; again++) {
    await opened.page.close();
    opened = await openOnce(context, name);
  }
  return opened;
}

async function openOnce(context, name) {
  const page = await context.newPage(), address = 'file://' + file(name), faults = [];
  page.on('pageerror', error => faults.push(`${name}: ${error.message}`));
  page.on('request', request => { if (request.url() !== address) faults.push(`${name} asks for ${request.url().slice(0, 120)}`); });
  page.on('console', message => {
    // Reading a drawing back is what screenshots do.
    if (['error', 'warning'].includes(message.type()) && !/GPU stall due to ReadPixels/.test(message.text())) faults.push(`${name}: ${message.text()}`);
  });
  const begin = Date.now();
  await page.goto(address, { waitUntil: 'load' });
  await page.evaluate(() => new Promise(done => requestAnimationFrame(() => requestAnimationFrame(done))));
  return { page, faults, took: Date.now() - begin };
}

const shoot = (page, name, fullPage = false) => shots && page.screenshot({ path: join(shots, `${name}.png`), fullPage });
const settle = page => page.evaluate(() => new Promise(done => requestAnimationFrame(() => requestAnimationFrame(done))));
const picture = page => page.evaluate(() => document.getElementById('view').toDataURL());
const clock = page => page.evaluate(() => Number(document.getElementById('time').value));
async function seek(page, time) {
  await page.evaluate(to => { const range = document.getElementById('time'); range.value = to; range.dispatchEvent(new Event('input')); }, time);
  await settle(page);
}

async function moves(page, name) {
  const end = await page.evaluate(() => Number(document.getElementById('time').max));
  assert.ok(end > 0, `${name} has no time`);
  await seek(page, 0.2 * end);
  const early = await picture(page);
  await seek(page, 0.5 * end);
  assert.notEqual(early, await picture(page), `${name}: the drawing does not change with time`);
  await seek(page, 0.2 * end);
  assert.equal(early, await picture(page), `${name}: the same time looks different`);

  // Keys: time, play and pause, views, zoom, reset.
  await page.focus('#stage');
  const before = await clock(page);
  await page.keyboard.press('ArrowRight');
  await settle(page);
  assert.ok(await clock(page) > before, `${name}: the right arrow does not go on`);
  await page.keyboard.press('ArrowLeft');
  await page.keyboard.press('ArrowLeft');
  await settle(page);
  assert.ok(await clock(page) < before, `${name}: the left arrow does not go back`);
  const paused = await clock(page);
  await page.keyboard.press(' ');
  await page.waitForTimeout(250);
  await page.keyboard.press(' ');
  await settle(page);
  assert.notEqual(await clock(page), paused, `${name}: space does not play`);
  const still = await clock(page);
  await page.waitForTimeout(120);
  assert.equal(await clock(page), still, `${name}: space does not pause`);
  await page.keyboard.press('r');
  await settle(page);
  const first = await picture(page), seen = new Set([first]);
  for (const key of ['3', '+']) { await page.keyboard.press(key); await settle(page); seen.add(await picture(page)); }
  assert.equal(seen.size, 3, `${name}: keys do not change the view`);
  await page.keyboard.press('r');
  await settle(page);
  assert.equal(await picture(page), first, `${name}: r does not reset`);

  // The mouse turns.
  const box = await page.locator('#view').boundingBox();
  await page.mouse.move(box.x + box.width / 2, box.y + box.height / 2);
  await page.mouse.down();
  await page.mouse.move(box.x + box.width / 2 + 60, box.y + box.height / 2 - 30, { steps: 3 });
  await page.mouse.up();
  await settle(page);
  assert.notEqual(await picture(page), first, `${name}: dragging does not turn`);
  await page.keyboard.press('r');
}

async function showsFigures(page, name) {
  const figures = await page.evaluate(() => [...document.querySelectorAll('.figure')].map(figure => {
    const box = figure.getBoundingClientRect(), marks = [...figure.querySelectorAll('g[clip-path] path, g[clip-path] circle')];
    return { title: figure.querySelector('title')?.textContent, wide: box.width, high: box.height, drawn: marks.some(mark => mark.getBBox().width + mark.getBBox().height > 5) };
  }));
  assert.ok(figures.length >= 6, `${name} has only ${figures.length} figures`);
  for (const { title, wide, high, drawn } of figures) assert.ok(title && wide > 100 && high > 100 && drawn, `${name}: figure "${title}" is empty`);
  return figures.length;
}

async function fitsPhones(page, name) {
  await page.setViewportSize({ width: 360, height: 780 });
  await settle(page);
  const wide = await page.evaluate(() => Math.max(document.documentElement.scrollWidth, document.body.scrollWidth));
  assert.ok(wide <= 360, `${name} is ${wide} px wide on a phone`);
  await shoot(page, `${name}-phone`, true);
  await page.setViewportSize({ width: 1280, height: 900 });
  await settle(page);
}

async function turnsDark(page, name) {
  const paper = () => page.evaluate(() => getComputedStyle(document.body).backgroundColor);
  const light = await paper(), drawn = await picture(page);
  await page.click('#theme');
  await settle(page);
  assert.notEqual(await paper(), light, `${name} does not turn dark`);
  assert.notEqual(await picture(page), drawn, `${name}: the replay does not turn dark`);
  await shoot(page, `${name}-dark`, true);
  await page.click('#theme');
  await page.emulateMedia({ colorScheme: 'dark' });
  assert.equal(await paper(), light, `${name}: what was chosen does not last`);
  await page.emulateMedia({ colorScheme: 'light' });
  await settle(page);
}

async function prints(page, name) {
  const path = join(shots || desk, `${name}.pdf`);
  await page.pdf({ path, format: 'A4' });
  assert.ok(statSync(path).size > 20_000, `${name} prints to next to nothing`);
}

// The page's kinematics beside those of the command line: where the left arm of dual_panda begins.
async function agrees(page) {
  await seek(page, 0);
  const shown = await page.evaluate(() => [...document.querySelector('#arms tbody tr').cells].slice(2).map(cell => Number(cell.textContent.replace('−', '-'))));
  const { position } = JSON.parse(readFileSync(join(desk, 'tip.json'))), mount = [-0.75, 0, 0];
  shown.forEach((value, k) => assert.ok(Math.abs(value - position[k] - mount[k]) < 6e-5, `tip at ${shown}, not ${position} + ${mount}`));
}

// A press into a figure over time goes to that time.
async function followsFigures(page, name) {
  const figure = page.locator('.figure[data-time] svg').first();
  await figure.scrollIntoViewIfNeeded();
  await seek(page, 0);
  const box = await figure.boundingBox();
  await figure.click({ position: { x: box.width / 2, y: box.height / 2 } });
  await settle(page);
  assert.ok(await clock(page) > 0, `${name}: a press into a figure does not go to its time`);
  const cursor = await page.evaluate(() => Number(document.querySelector('.figure[data-time] .cursor').getAttribute('x1')));
  assert.ok(cursor > 50, `${name}: the line in the figure does not follow`);
}

async function timed(what, act) {
  const begin = Date.now();
  await act();
  console.log(`${what}: ${((Date.now() - begin) / 1000).toFixed(1)} s`);
}

await inBrowser(WEBGL, async context => {
  for (const name of ['dual_panda', 'planar_dual', 'shared_torso', 'stopped', 'long']) await timed(name, async () => {
    const { page, faults, took } = await open(context, name);
    const kind = await page.evaluate(() => document.getElementById('view').getContext('webgl2') ? 'WebGL' : 'plain');
    assert.equal(kind, 'WebGL', `${name} is drawn on a ${kind} canvas`);
    assert.ok(took < 3000, `${name} takes ${took} ms to open`);
    const size = statSync(file(name)).size;
    assert.ok(size < 10e6, `${name} has ${size} bytes`);
    await moves(page, name);
    const figures = await showsFigures(page, name);
    await followsFigures(page, name);
    if (name === 'dual_panda') await agrees(page);
    await page.evaluate(() => scrollTo(0, 0));
    await shoot(page, name);
    await fitsPhones(page, name);
    await turnsDark(page, name);
    await prints(page, name);
    const words = await page.evaluate(() => document.querySelector('.status').textContent);
    assert.match(words, name === 'stopped' ? /Stopped/ : /Completed/);
    assert.deepEqual(faults, []);
    console.log(`  opens in ${took} ms, ${(size / 1024).toFixed(0)} KiB, ${figures} figures`);
    await page.close();
  });
  await timed('singular', async () => {
    const { page, faults } = await open(context, 'singular');
    assert.match(await page.evaluate(() => document.querySelector('.verdict').textContent), /Stopped.*0 of 1000 steps/s);
    assert.ok(await page.evaluate(() => document.getElementById('play').disabled), 'there is nothing to play');
    await shoot(page, 'singular');
    assert.deepEqual(faults, []);
    await page.close();
  });
  // The policy holds: what is slipped into a page is not run.
  const slipped = readFileSync(file('planar_dual'), 'utf8').replace('</main>', '<script>document.title = "run"</script></main>');
  writeFileSync(join(desk, 'slipped.html'), slipped);
  const page = await context.newPage();
  await page.goto('file://' + join(desk, 'slipped.html'));
  assert.notEqual(await page.title(), 'run', 'a script that is not ours runs');
});

await inBrowser(PLAIN, async context => {
  for (const name of ['dual_panda', 'planar_dual']) await timed(`${name} without WebGL`, async () => {
    const { page, faults } = await open(context, name);
    await moves(page, `${name} without WebGL`);
    await page.evaluate(() => scrollTo(0, 0));
    await shoot(page, `${name}-plain`);
    assert.deepEqual(faults, []);
    await page.close();
  });
});
console.log('the pages do what they should');
