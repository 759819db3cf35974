/** Whether the page shows its dark theme now, for what is drawn on a canvas. */

class PageTheme {
  isDark: boolean = $state(true);

  constructor() {
    if (typeof document === 'undefined') return;
    const root = document.documentElement;
    const read = (): void => {
      this.isDark = root.dataset.theme !== 'light';
    };
    read();
    new MutationObserver(read).observe(root, { attributes: true, attributeFilter: ['data-theme'] });
  }
}

export const pageTheme = new PageTheme();
