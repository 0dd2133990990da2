import { readyGraphics } from './lib/graphics';

const page = import('./page');
readyGraphics();
await page;
