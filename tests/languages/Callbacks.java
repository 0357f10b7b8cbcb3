// SPDX-License-Identifier: Apache-2.0
import java.nio.ByteBuffer;
import java.nio.file.Files;
import java.nio.file.Path;
import java.util.ArrayList;
import java.util.Arrays;
import java.util.List;
import java.util.concurrent.atomic.AtomicInteger;

import org.odograph.Abi;
import org.odograph.OdographException;
import org.odograph.Session;

/** What a consumer throws, an Error too, comes out of push once, and events go on; it cannot close the session. Threads of closed live
 * sessions are no longer attached. A picture outside its buffer is refused. A map of an earlier session, which is the argument, is saved as it was. */
public final class Callbacks {
    private static final String CONFIG = "odograph: 1\nattitude: {plugin: attitude/vqf}\n";

    private static void expect(boolean holds, Object what) {
        if (!holds) throw new IllegalStateException("not so: " + what);
    }

    private static void feed(Session session, int from, int to, List<Throwable> thrown) {
        for (int i = from; i < to; ++i) {
            try {
                session.push(new Abi.Imu(1000000000L + i * 5000000L).flags(Abi.ODO_IMU_GYRO | Abi.ODO_IMU_ACCEL).accel_b(0, 0, 9.8));
                if (i % 50 == 49) session.flush();
            } catch (Throwable e) {
                thrown.add(e);
            }
        }
    }

    @SuppressWarnings("try") // close() in the consumer is what is tested
    private static void callbacks(boolean live) {
        AtomicInteger seen = new AtomicInteger();
        List<Throwable> thrown = new ArrayList<>();
        try (Session session = new Session(CONFIG, live, "")) {
            session.onEvent(event -> {
                int n = seen.incrementAndGet();
                if (n == 20) throw new AssertionError("once");
                if (n == 200) session.close();
            });
            feed(session, 0, 400, thrown);
        }
        expect(seen.get() > 300, "events " + seen.get());
        expect(thrown.size() == 2 && thrown.get(0) instanceof AssertionError && thrown.get(1) instanceof IllegalStateException, thrown);
    }

    private static int threads() { return Thread.getAllStackTraces().size(); }

    public static void main(String[] arguments) throws Exception {
        callbacks(false);
        callbacks(true);
        int before = threads();
        for (int i = 0; i < 50; ++i)
            try (Session session = new Session(CONFIG, true, "")) {
                session.onEvent(event -> {});
                feed(session, 0, 50, new ArrayList<>());
            }
        Thread.sleep(200);
        expect(threads() < before + 10, threads() - before + " threads more");
        try (Session session = new Session(CONFIG)) {
            ByteBuffer pixels = ByteBuffer.allocateDirect(640 * 480);
            for (int[] wrong : new int[][] {{0, -640}, {-1, 640}, {0, 639}, {1, 640}})
                try {
                    session.pushFrame(new Abi.Frame(1).format(Abi.ODO_FORMAT_GREY8).width(640).height(480), pixels, wrong[0], wrong[1]);
                    expect(false, "begin " + wrong[0] + ", stride " + wrong[1] + " was refused");
                } catch (IllegalArgumentException e) {
                    expect(e.getMessage() != null, e);
                }
        }
        try (Session session = new Session(CONFIG + "absolute_fixers: {plugin: fix/map}\n")) {
            byte[] map = Files.readAllBytes(Path.of(arguments[0]));
            expect(session.saveMap().length == 0, "there is a map before");
            try {
                session.loadMap(new byte[] {1, 2, 3});
                expect(false, "a damaged map was refused");
            } catch (OdographException e) {
                expect(e.getMessage() != null, e);
            }
            session.loadMap(map);
            expect(Arrays.equals(session.saveMap(), map), "the same map");
        }
    }
}
