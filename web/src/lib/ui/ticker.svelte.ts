/** A counter that a component reads to be drawn again some times a second, for values that are not reactive. */
import { onMount } from 'svelte';

export function ticker(interval: number): { readonly count: number } {
  let count = $state(0);
  onMount(() => {
    const timer = setInterval(() => (count += 1), interval);
    return () => clearInterval(timer);
  });
  return {
    get count() {
      return count;
    },
  };
}
