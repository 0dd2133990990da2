import { readyGraphics } from './scene/graphics';

const page = import('./page');
readyGraphics();
await page;
