/** A counter that a component reads to be drawn again some times a second, for values that are not reactive. */
import { onMount } from 'svelte';

/** @param isPaused while it returns true the counter stands still, and the component shows what it has shown */
export function ticker(interval: number, isPaused: () => boolean = () => false): { readonly count: number } {
  let count = $state(0);
  onMount(() => {
    const timer = setInterval(() => {
      if (!isPaused()) count += 1;
    }, interval);
    return () => clearInterval(timer);
  });
  return {
    get count() {
      return count;
    },
  };
}
