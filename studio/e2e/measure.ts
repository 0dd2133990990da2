// How fast the page is: `npm run measure`, with JOINTPLAY_COMMAND a release build. Prints a table, and judges nothing.

import { mkdtempSync, readdirSync, readFileSync, rmSync, writeFileSync } from 'node:fs';
import { cpus, tmpdir } from 'node:os';
import { join, resolve } from 'node:path';
import { gzipSync } from 'node:zlib';
import { afterAll, test } from 'vitest';
import { ROOT, browse, drawn, load, serve, until } from './studio';

const median = (values: number[]) => [...values].sort((a, b) => a - b)[values.length >> 1] as number;
const rows: [string, string][] = [];
const report = (what: string, found: string) => rows.push([what, found]);
const ms = (value: number) => `${value.toFixed(1)} ms`;
const range = (values: number[]) => `${Math.min(...values).toFixed(0)} to ${Math.max(...values).toFixed(0)} ms`;

afterAll(() => {
  console.log(`\n${cpus()[0]?.model}, ${cpus().length} threads, drawing in software\n`);
  for (const [what, found] of rows) console.log(`| ${what} | ${found} |`);
});

test('the robot alone', async () => {
  const dist = resolve(ROOT, 'crates/jointplay-studio/page');
  const files = readdirSync(dist, { recursive: true, withFileTypes: true }).filter((entry) => entry.isFile());
  const weight = files.reduce((sum, { parentPath, name }) => sum + gzipSync(readFileSync(resolve(parentPath, name))).length, 0);
  report('page, compressed by gzip', `${(weight / 1024).toFixed(0)} KiB`);

  const browser = await browse();
  const warm = await browser.newPage();
  await warm.goto('about:blank');
  const begun = performance.now();
  const server = await serve();
  const up = performance.now();
  const page = await browser.newPage({ viewport: { width: 1280, height: 720 }, reducedMotion: 'reduce' });
  await load(page, server.address);
  await until('panels', () => page.evaluate(() => document.querySelector('aside') !== null));
  const panels = performance.now();
  await drawn(page);
  report('`jointplay studio` to its address', ms(up - begun));
  report('to panels with numbers', ms(panels - begun));
  report('to the first picture', ms(performance.now() - begun));
  await new Promise((wait) => setTimeout(wait, 2000));

  const steps = await page.evaluate(async () => {
    const { probe } = window.jointplay;
    const slider = document.querySelector<HTMLInputElement>('[data-testid=slider-tilt]')!;
    const found: { total: number; server: number; page: number }[] = [];
    for (let i = 0; i < 120; i++) {
      performance.clearResourceTimings();
      const before = probe.pose;
      const start = performance.now();
      slider.value = String(0.2 + (i % 60) * 0.02);
      slider.dispatchEvent(new Event('input', { bubbles: true }));
      while (probe.pose === before) await new Promise((next) => requestAnimationFrame(next));
      const total = probe.renderedAt - start;
      const [request] = performance.getEntriesByType('resource').filter(({ name }) => name.endsWith('/pose')) as PerformanceResourceTiming[];
      found.push({ total, page: probe.took_ms, server: request ? request.responseEnd - request.requestStart : NaN });
    }
    return found.slice(20);
  });
  report('slider to drawn picture, median', ms(median(steps.map(({ total }) => total))));
  report('of it the request and its answer', ms(median(steps.map(({ server }) => server))));

  report('of it the page’s own work at the picture', ms(median(steps.map(({ page }) => page))));

  const count = () => page.getByTestId('sample').getAttribute('data-count');
  await page.getByTestId('motion').selectOption('raster');
  await until('samples', async () => (await count()) === '777');
  await page.getByRole('button', { name: 'Range' }).click();
  await page.getByTestId('azimuth-step').fill('1');
  await page.getByTestId('azimuth-step').press('Enter');
  await until('samples', async () => (await count()) === '7581');
  await page.getByLabel('Speed').selectOption('2');
  const play = await page.evaluate(async () => {
    document.querySelector<HTMLElement>('[data-testid=play]')!.click();
    const { probe } = window.jointplay;
    const start = performance.now();
    const from = probe.frames;
    let frames = 0;
    while (performance.now() - start < 5000) {
      frames += 1;
      await new Promise((next) => requestAnimationFrame(next));
    }
    document.querySelector<HTMLElement>('[data-testid=play]')!.click();
    const end = performance.now();
    const seconds = (end - start) / 1000;
    const pictures = (probe.frames - from) / seconds;
    // A browser without a graphics card still draws earlier commands: frames come at their pace again once it is done.
    let last = end;
    for (let calm = 0; calm < 5; ) {
      await new Promise((next) => requestAnimationFrame(next));
      const now = performance.now();
      calm = now - last < 50 ? calm + 1 : 0;
      last = now;
    }
    return { frames: frames / seconds, pictures, calm_ms: performance.now() - end };
  });
  report('playing 7,581 samples with six plots', `${play.frames.toFixed(0)} frames/s, ${play.pictures.toFixed(0)} pictures/s`);
  report('from pause until all is drawn', ms(play.calm_ms));

  await page.evaluate(() => {
    const seen = { longest: 0, last: performance.now() };
    Object.assign(window, { seen });
    const tick = () => {
      const now = performance.now();
      seen.longest = Math.max(seen.longest, now - seen.last);
      seen.last = now;
      requestAnimationFrame(tick);
    };
    tick();
  });
  const large = performance.now();
  await page.getByTestId('azimuth-step').fill('0.0075');
  await page.getByTestId('azimuth-step').press('Enter');
  await until('samples', async () => (await count()) === '1008021');
  const took = performance.now() - large;
  const { longest, heap } = await page.evaluate(() => {
    const { seen } = window as unknown as { seen: { longest: number } };
    const { memory } = performance as unknown as { memory: { usedJSHeapSize: number } };
    return { longest: seen.longest, heap: memory.usedJSHeapSize };
  });
  report('1,008,021 samples computed, sent and plotted', `${(took / 1000).toFixed(1)} s`);
  report('longest pause between frames meanwhile', ms(longest));
  report('memory of scripts afterwards', `${(heap / 2 ** 20).toFixed(0)} MiB`);
  await browser.close();
  await server.stop();
});

/** CPU time of the browser's graphics process [ms]: it renders the pictures where there is no graphics card. Linux only. */
function graphicsCpu(): number {
  let sum = 0;
  for (const id of readdirSync('/proc').filter((name) => /^\d+$/.test(name)))
    try {
      if (!readFileSync(`/proc/${id}/cmdline`, 'utf8').includes('--type=gpu-process') || !descends(Number(id))) continue;
      const fields = stat(Number(id));
      // Clock ticks of 10 ms in user and kernel mode.
      sum += 10 * (Number(fields[11]) + Number(fields[12]));
    } catch {
      // The process has ended.
    }
  return sum;
}
const stat = (id: number) => readFileSync(`/proc/${id}/stat`, 'utf8').replace(/^.*\) /, '').split(' ');
/** Whether a process was started by this one. */
function descends(id: number): boolean {
  for (let at = id; at > 1; at = Number(stat(at)[1])) if (at === process.pid) return true;
  return false;
}

for (const [name, words, counter] of [['robot', [], 'frames'], ['mechanism', ['gpr-mechanism'], 'mechanismFrames'], ['cell', ['--cell', 'example'], 'cellFrames']] as const)
  test(`rotation of the view: ${name}`, async () => {
    const [browser, server] = await Promise.all([browse(), serve(0, [...words])]);
    const page = await browser.newPage({ viewport: { width: 1440, height: 900 }, reducedMotion: 'reduce' });
    await load(page, server.address);
    await until('a picture', () => page.evaluate((of) => window.jointplay.probe[of] > 0, counter));
    await new Promise((wait) => setTimeout(wait, 3000));
    const before = graphicsCpu();
    const found = await page.evaluate(async (of) => {
      const canvas = document.querySelector<HTMLCanvasElement>('canvas[role=img]')!;
      const { left, top, width, height } = canvas.getBoundingClientRect();
      canvas.setPointerCapture = canvas.releasePointerCapture = () => undefined;
      const send = (type: string, x: number, buttons: number) =>
        canvas.dispatchEvent(new PointerEvent(type, { clientX: left + 0.3 * width + x, clientY: top + 0.75 * height, buttons, pointerId: 1, bubbles: true, isPrimary: true }));
      send('pointerdown', 0, 1);
      const [start, first] = [performance.now(), window.jointplay.probe[of]];
      for (let i = 0; performance.now() - start < 6000; i++) {
        send('pointermove', 3 * (i % 60), 1);
        await new Promise((next) => requestAnimationFrame(next));
      }
      const pictures = window.jointplay.probe[of] - first;
      const seconds = (performance.now() - start) / 1000;
      const resolution = canvas.width / width;
      send('pointerup', 0, 0);
      return { pictures, seconds, resolution };
    }, counter);
    const cpu = (graphicsCpu() - before) / found.pictures;
    report(`rotation of the ${name} in a window of 1440 × 900`, `${(found.pictures / found.seconds).toFixed(0)} pictures/s at ${(100 * found.resolution).toFixed(0)} % of the resolution, ${cpu.toFixed(0)} ms of CPU each`);
    await browser.close();
    await server.stop();
  });

for (const [entry, joint] of [['four-bar', 'C'], ['hexapod', ''], ['gpr-mechanism', '']] as const)
  test(`drag of a link: ${entry}`, async () => {
    const [browser, server] = await Promise.all([browse(), serve(0, [entry])]);
    const page = await browser.newPage({ viewport: { width: 1440, height: 900 }, reducedMotion: 'reduce' });
    await load(page, server.address);
    await until('the mobility', async () => (await page.getByTestId('m-finite').count()) === 1);
    const took = await page.evaluate(async (wanted) => {
      const { probe } = window.jointplay;
      const canvas = document.querySelector<HTMLCanvasElement>('canvas[role=img]')!;
      canvas.setPointerCapture = canvas.releasePointerCapture = () => undefined;
      const name = wanted || Object.keys(probe.mechanism!.joints()).at(-1)!;
      const { x, y } = probe.mechanism!.onPage(name)!;
      const send = (type: string, by: number, buttons: number) => canvas.dispatchEvent(new PointerEvent(type, { clientX: x + by, clientY: y - 0.6 * by, buttons, pointerId: 1, bubbles: true, isPrimary: true }));
      send('pointerdown', 0, 1);
      const found: number[] = [];
      for (let i = 1; i <= 40; i++) {
        const [start, before] = [performance.now(), JSON.stringify(probe.mechanism!.joints())];
        send('pointermove', 5 + 3 * (i % 14), 1);
        while (JSON.stringify(probe.mechanism!.joints()) === before && performance.now() - start < 3000) await new Promise((next) => requestAnimationFrame(next));
        found.push(performance.now() - start);
      }
      send('pointerup', 0, 0);
      return found;
    }, joint);
    report(`drag of a link of ${entry}, from the pointer to the moved picture, median`, ms(median(took)));
    await browser.close();
    await server.stop();
  });

/** The mechanism file of a scissor lift of some stages: two links in each, and four more. */
function scissorLift(stages: number): string {
  const joint = (name: string, kind: string, links: [string, string], [x, y]: [string, number], more = '') =>
    `[[joint]]\nname = "${name}"\nkind = "${kind}"\nlinks = ["${links[0]}", "${links[1]}"]\npoint = ["${x}", "${y} * h", 0]\naxis = ${kind === 'prismatic' ? '[1, 0, 0]' : '[0, 0, 1]'}\n${more}`;
  const parts = [
    'kind = "mechanism"\nname = "Scissor lift"\nunits = { length = "m", angle = "deg" }\nbase = "base"\n[parameters]\nbar = 0.8\nangle = 35\nw = "bar * cos(angle)"\nh = "bar * sin(angle)"',
    joint('slide', 'prismatic', ['base', 'slider'], ['w', 0], 'actuated = true'),
    joint('foot left', 'revolute', ['base', 'left 1'], ['0', 0]),
    joint('foot right', 'revolute', ['slider', 'right 1'], ['w', 0]),
  ];
  for (let k = 1; k <= stages; k++) {
    parts.push(joint(`cross ${k}`, 'revolute', [`left ${k}`, `right ${k}`], ['w / 2', k - 0.5]));
    if (k < stages) parts.push(joint(`pin right ${k}`, 'revolute', [`left ${k}`, `right ${k + 1}`], ['w', k]), joint(`pin left ${k}`, 'revolute', [`right ${k}`, `left ${k + 1}`], ['0', k]));
  }
  parts.push(joint('head left', 'revolute', [`right ${stages}`, 'table'], ['0', stages]), joint('head right', 'revolute', [`left ${stages}`, 'head'], ['w', stages]), joint('head', 'prismatic', ['table', 'head'], ['w', stages]));
  return parts.join('\n');
}

test('a slider of a mechanism with 102 links', async () => {
  const folder = mkdtempSync(join(tmpdir(), 'measure-'));
  const file = join(folder, 'lift.toml');
  writeFileSync(file, scissorLift(49));
  const [browser, server] = await Promise.all([browse(), serve(0, [file])]);
  const page = await browser.newPage({ viewport: { width: 1440, height: 900 }, reducedMotion: 'reduce' });
  await load(page, server.address);
  await until('the slider', async () => (await page.getByTestId('slide-slide').count()) === 1);
  await new Promise((wait) => setTimeout(wait, 5000));
  const found = await page.evaluate(async () => {
    const { probe } = window.jointplay;
    const slider = document.querySelector<HTMLInputElement>('[data-testid=slide-slide]')!;
    const [low, high] = [Number(slider.min), Number(slider.max)];
    const start = performance.now();
    const first = probe.mechanismFrames;
    performance.clearResourceTimings();
    performance.setResourceTimingBufferSize(2000);
    for (let i = 0; performance.now() - start < 8000; i++) {
      slider.value = String(low + (high - low) * (0.5 + 0.3 * Math.sin(i / 20)));
      slider.dispatchEvent(new Event('input', { bubbles: true }));
      await new Promise((next) => requestAnimationFrame(next));
    }
    const seconds = (performance.now() - start) / 1000;
    const requests = performance.getEntriesByType('resource').filter(({ name }) => name.endsWith('/drive')) as PerformanceResourceTiming[];
    return { pictures: (probe.mechanismFrames - first) / seconds, positions: requests.length / seconds, took: requests.map(({ responseEnd, requestStart }) => responseEnd - requestStart) };
  });
  report('slider of a lift of 102 links in a window of 1440 × 900', `${found.pictures.toFixed(0)} pictures/s, ${found.positions.toFixed(0)} positions/s`);
  report('of it a position by the server, median', ms(median(found.took)));
  await browser.close();
  await server.stop();
  rmSync(folder, { recursive: true });
});

const STATIONS = ['LP1', 'LP2', 'ALIGN', 'PM1'];

test('plans of the example cell', async () => {
  const server = await serve(0, ['--cell', 'example']);
  const headers = { 'content-type': 'application/json', origin: server.address.slice(0, -1) };
  const ask = async (path: string, body?: object) => {
    const method = body ? 'POST' : 'GET';
    const answer = await fetch(`${server.address}api/v1/${path}`, { method, headers, body: body && JSON.stringify(body) });
    if (!answer.ok) throw new Error(`${path}: ${await answer.text()}`);
    return answer.text();
  };
  const { cell } = JSON.parse(await ask('cell')) as { cell: string };
  const plan = async (cell: string) => {
    const start = performance.now();
    const answer = await ask('cell/plan', { cell });
    return { took: performance.now() - start, answer };
  };
  const first = await plan(cell);
  report('first plan and its answer, no other page', ms(first.took));
  const { stations } = JSON.parse(first.answer) as { stations: { name: string; position_mm: number[] }[] };
  for (const station of STATIONS) {
    const [x, y, z] = stations.find(({ name }) => name === station)!.position_mm.map((value) => value / 1000) as [number, number, number];
    const found: number[] = [];
    for (let i = 1; i <= 9; i++) {
      const moved = await ask('cell/station', { cell, station, position_m: [x + i * 1e-5, y, z] });
      found.push((await plan((JSON.parse(moved) as { cell: string }).cell)).took);
    }
    report(`${station} moved, the plan and its answer`, range(found.slice(1)));
    await plan(cell);
  }
  await server.stop();
});

test('the example cell in a browser', async () => {
  const [browser, server] = await Promise.all([browse(), serve(0, ['--cell', 'example'])]);
  const page = await browser.newPage({ viewport: { width: 1280, height: 720 }, reducedMotion: 'reduce' });
  await load(page, server.address);
  const calm = (pictures = 0) =>
    until('the cell as it moves', () =>
      page.evaluate((seen) => {
        const shown = document.querySelector('[data-testid=planned]')?.textContent?.startsWith('Planned in');
        return Boolean(shown) && window.jointplay.probe.cellFrames > seen;
      }, pictures),
    );
  await calm();
  for (const station of STATIONS) {
    await page.locator('summary', { hasText: station }).click();
    const found: { server: number; total: number }[] = [];
    for (let i = 0; i < 9; i++) {
      const drawn = await page.evaluate(() => window.jointplay.probe.cellFrames);
      found.push(
        await page.evaluate(async (name) => {
          const { probe } = window.jointplay;
          const input = document.querySelector<HTMLInputElement>(`[data-testid=station-${name}-x]`)!;
          const before = probe.checks;
          performance.clearResourceTimings();
          const start = performance.now();
          input.value = String(Number(input.value) + 0.01);
          input.dispatchEvent(new Event('change', { bubbles: true }));
          while (probe.checks === before) await new Promise((next) => setTimeout(next, 1));
          const [plan] = performance.getEntriesByType('resource').filter(({ name }) => name.endsWith('/plan')) as PerformanceResourceTiming[];
          return { total: probe.checkShownAt - start, server: plan ? plan.responseEnd - plan.requestStart : NaN };
        }, station),
      );
      await calm(drawn);
      // The browser may still be drawing the last commands of the page.
      await new Promise((wait) => setTimeout(wait, 2000));
    }
    report(`${station} moved by a number typed, to the check result`, range(found.slice(1).map(({ total }) => total)));
    report('of it the plan and its answer', range(found.slice(1).map(({ server }) => server)));
  }
  await browser.close();
  await server.stop();
});
