import { prepareContext } from './scene/webgl';

const page = import('./page');
prepareContext();
await page;
