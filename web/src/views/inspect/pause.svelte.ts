/** Whether the lists, the fields and the packet of the view stand still; what arrives is counted nevertheless. */
class Pause {
  isOn: boolean = $state(false);
}

export const pause = new Pause();
