/** The address of the page: `#/plan/mission` is the view `plan` with the rest `mission`. */

/** Returns a part of an address; one that is not well encoded stays as it is. */
function decoded(part: string): string {
  try {
    return decodeURIComponent(part);
  } catch {
    return part;
  }
}

class Route {
  view = $state('');
  /** Rest of the address behind the view's name; each view has its own meaning for it. */
  rest = $state('');

  /** Follows the address from now on; returns the function that ends it. */
  follow(): () => void {
    const read = (): void => this.read(location.hash);
    read();
    addEventListener('hashchange', read);
    return () => removeEventListener('hashchange', read);
  }

  read(hash: string): void {
    const [view = '', ...rest] = hash.replace(/^#\/?/, '').split('/');
    this.view = view;
    this.rest = rest.map(decoded).join('/');
  }

  /** Shows a view. */
  go(view: string, rest = ''): void {
    location.hash = rest === '' ? `#/${view}` : `#/${view}/${rest.split('/').map(encodeURIComponent).join('/')}`;
  }
}

export const route = new Route();
