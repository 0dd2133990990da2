// A server that was restarted may be another version of jointplay, with another page than this one.

import { connection } from './connection.svelte';

/** Whether the server has this page, judged by the name of its script, which contains a hash of its content. */
async function isPageOfServer(): Promise<boolean> {
  const script = document.querySelector('script[type="module"][src]')?.getAttribute('src') ?? '';
  const response = await fetch('./', { cache: 'no-store' });
  return !response.ok || (await response.text()).includes(`"${script}"`);
}

class PageVersion {
  /** Whether the server has another page since the last reconnection. */
  isOutdated = $state(false);

  constructor() {
    connection.onReconnect(() => void this.#compare());
  }

  async #compare(): Promise<void> {
    try {
      this.isOutdated = !(await isPageOfServer());
    } catch {
      // The next reconnection compares again.
    }
  }
}

export const pageVersion = new PageVersion();
