// What the pages of mdBook lack for users of a keyboard; `xtask/src/book/accessible.rs` changes the rest.
(() => {
  const toggle = document.getElementById('mdbook-sidebar-toggle');
  const checkbox = document.getElementById('mdbook-sidebar-toggle-anchor');
  toggle?.addEventListener('click', () => {
    checkbox.checked = !checkbox.checked;
    checkbox.dispatchEvent(new Event('change'));
  });
  // Whatever is wider than the page can be scrolled by keys.
  const update = () => {
    for (const box of document.querySelectorAll('pre > code, .table-wrapper, .formula')) {
      if (box.scrollWidth > box.clientWidth) box.tabIndex = 0;
      else box.removeAttribute('tabindex');
    }
  };
  addEventListener('load', update);
  addEventListener('resize', update);
})();
