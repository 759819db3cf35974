/** Decides when the map shows all vehicles by itself: while they and the panels beside the map are still coming. */

/** Time in ms after the first vehicle in which others, and the sizes of panels, become known. */
const SETTLING_TIME = 3000;
/** So few vehicles are shown whenever one more is found. */
const MAX_SMALL_FLEET = 8;

export class Fitting {
  private count = 0;
  private edges = '';
  private since = 0;

  /** Forgets the fleet: the link was left. */
  reset(): void {
    this.count = 0;
  }

  /**
   * Returns whether the map shall show all vehicles now.
   *
   * @param count - Vehicles whose positions are known.
   * @param edges - What the panels cover, as text.
   * @param isFree - The user has not moved the map, and it follows no vehicle.
   */
  wants(count: number, edges: string, isFree: boolean, now: number): boolean {
    if (count === 0) return false;
    const isFirst = this.count === 0;
    if (isFirst) this.since = now;
    const isSettling = now - this.since < SETTLING_TIME;
    const hasMore = count > this.count && (isSettling || this.count < MAX_SMALL_FLEET);
    const hasMoved = isSettling && edges !== this.edges;
    if (!isFirst && !(isFree && (hasMore || hasMoved))) return false;
    this.count = count;
    this.edges = edges;
    return true;
  }
}
