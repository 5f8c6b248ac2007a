// Gives every module of the page an address and starts `main`. It runs before any module is loaded, so the import map is known.
{
  const imports = Object.fromEntries(
    [...document.querySelectorAll('script[data-module]')].map((element) => {
      const name = /** @type {HTMLElement} */ (element).dataset.module ?? '';
      // the name appears in error messages and in the debugger
      const source = `${element.textContent}\n//# sourceURL=${name.slice(1)}`;
      return [name, URL.createObjectURL(new Blob([source], { type: 'text/javascript' }))];
    }),
  );
  const map = document.createElement('script');
  map.type = 'importmap';
  map.textContent = JSON.stringify({ imports });
  document.head.append(map);
  const start = document.createElement('script');
  start.type = 'module';
  start.textContent = "import { start } from '#page/main.js';\nawait start();";
  document.body.append(start);
}
