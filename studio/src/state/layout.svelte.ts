// How the page is arranged; kept between visits, and no part of undo.

import { load, save } from '../lib/settings';

const object = (value: unknown) => typeof value === 'object' && value !== null;

class Layout {
  plots = $state(true);
  plotsHeight = $state(load('plotsHeight', 300, (value) => typeof value === 'number' && value >= 160));
  closed = $state<Record<string, boolean>>(load('closed', {}, object));
  helpOpen = $state(false);
  explainOpen = $state(false);
  storyShown = $state(load('story', true, (value) => typeof value === 'boolean'));
  handles = $state(load('handles', true, (value) => typeof value === 'boolean'));
  /** The plot shown alone, if one is. */
  alone = $state<string | null>(null);

  toggleSection(name: string): void {
    this.closed = { ...this.closed, [name]: !this.closed[name] };
    save('closed', this.closed);
  }

  setPlotsHeight(height: number): void {
    this.plotsHeight = Math.round(Math.min(Math.max(height, 160), window.innerHeight - 330));
    save('plotsHeight', this.plotsHeight);
  }

  setStory(shown: boolean): void {
    this.storyShown = shown;
    save('story', shown);
  }

  setHandles(shown: boolean): void {
    this.handles = shown;
    save('handles', shown);
  }
}

export const layout = new Layout();
