// Several passes in one virtual machine: the first ones warm it up, the median of the others counts.

import java.util.Arrays;
import java.util.function.IntSupplier;

final class Passes {
    private static final int WARM_UP = 4;
    private static final int COUNTED = 5;

    private Passes() {}

    static double median(IntSupplier pass, int count) {
        double[] seconds = new double[COUNTED];
        for (int i = -WARM_UP; i < COUNTED; i++) {
            long start = System.nanoTime();
            int done = pass.getAsInt();
            if (done != count) {
                throw new IllegalStateException("counted " + done + " of " + count + " messages");
            }
            if (i >= 0) {
                seconds[i] = (System.nanoTime() - start) / 1e9 / count;
            }
        }
        Arrays.sort(seconds);
        return seconds[COUNTED / 2];
    }
}
