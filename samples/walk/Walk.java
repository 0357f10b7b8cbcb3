// SPDX-License-Identifier: Apache-2.0
import java.nio.ByteBuffer;
import java.nio.charset.StandardCharsets;
import java.util.Locale;
import java.util.concurrent.atomic.AtomicInteger;

import org.odograph.Abi;
import org.odograph.Event;
import org.odograph.Recording;
import org.odograph.Session;

/** Reads a recording, and tracks a walk live, in Java: java Walk CONFIG.yaml RECORDING.odo */
public final class Walk {
    private static final String CONFIG = String.join("\n", "odograph: 1", "walker: {height: 1.70 m}", "attitude: {plugin: attitude/vqf}",
        "step_estimator: {plugin: step/odograph}", "coupling: {type: localizer}",
        "navigation: {start: {position: [0 m, 0 m, 0 m], heading: 0 deg}}", "");

    private static void show(Event event) {
        if (event.type() == Abi.ODO_TYPE_POINTS) { // landmarks, the most certain first
            Abi.Point first = event.point(0);
            System.out.println("points " + event.points() + " first " + first.id() + " " + (double) first.p_c(2));
            return;
        }
        Abi.Pose pose = new Abi.Pose(event);
        double[] p = pose.p_n(), q = pose.q_n();
        System.out.println("pose " + pose.t_ns() + " " + p[0] + " " + p[1] + " " + p[2] + " " + q[1] + " " + q[2] + " " + q[3] + " " + q[0]);
    }

    /** Offset of the pixels of a grey picture. PGM needs no library; an app decodes JPEG and PNG with its own library. */
    private static int decode(ByteBuffer picture, Abi.Frame frame) {
        byte[] head = new byte[24];
        picture.duplicate().get(head);
        String[] words = new String(head, StandardCharsets.US_ASCII).split("\\s+", 5);
        frame.format(Abi.ODO_FORMAT_GREY8).width(Integer.parseInt(words[1])).height(Integer.parseInt(words[2]));
        return words[0].length() + words[1].length() + words[2].length() + words[3].length() + 4;
    }

    /** Puts an anchor on what lies ahead, 45 degrees down: usually the floor. */
    private static void place(Session session) {
        Abi.Hit hit = session.hitTest(new Abi.Ray().kind(Abi.ODO_RAY_VIEW).t_ns(Abi.ODO_TIME_LATEST).direction(0, 1, 1));
        if (hit == null) return;
        long anchor = session.createAnchor(Session.placeOf(hit, Abi.ODO_WORLD_CORRECTED), "on the floor");
        System.out.println("hit " + hit.what() + " " + hit.surface() + " " + hit.distance_m() + " anchor " + anchor);
    }

    private static void replay(String config, String file) {
        try (Session session = new Session(config); Recording recording = new Recording(file)) {
            session.onEvent(Walk::show, Abi.ODO_TYPE_POSE, Abi.ODO_TYPE_POINTS);
            for (Recording.Recorded recorded : recording) {
                if (recorded.picture != null) {
                    Abi.Frame frame = new Abi.Frame(recorded.message);
                    ByteBuffer picture = ByteBuffer.allocateDirect(recorded.picture.capacity()).put(recorded.picture.duplicate());
                    int begin = decode(recorded.picture, frame);
                    session.pushFrame(frame, picture, begin, frame.width());
                } else if (recorded.message.isInput()) {
                    session.push(recorded.message);
                }
            }
            session.flush();
            place(session);
        }
    }

    private static void live() {
        AtomicInteger steps = new AtomicInteger();
        ByteBuffer picture = ByteBuffer.allocateDirect(64 * 48); // as from a camera
        while (picture.hasRemaining()) picture.put((byte) 90);
        try (Session session = new Session(CONFIG, true, "")) {
            session.onEvent(event -> steps.incrementAndGet(), Abi.ODO_TYPE_STEP);
            Abi.Imu imu = new Abi.Imu(0).flags(Abi.ODO_IMU_GYRO | Abi.ODO_IMU_ACCEL);
            Abi.Frame frame = new Abi.Frame(0).format(Abi.ODO_FORMAT_GREY8).width(64).height(48);
            for (int i = 0; i < 1000; ++i) {
                double t = i * 0.01;
                long t_ns = 1_000_000_000L + i * 10_000_000L;
                session.push(imu.t_ns(t_ns).gyro_b(0, 0.01, 0).accel_b(0.1, 9.81 + 2.2 * Math.sin(12 * t), 0.4));
                if (i % 10 != 0) continue;
                session.pushFrame(frame.t_ns(t_ns), picture, 0, 64); // shared, not copied
                session.flush(); // needed only because the simulated time does not wait
            }
            Abi.Pose pose = session.pose();
            long label = session.createAnchor(new Abi.AnchorPlace().kind(Abi.ODO_ANCHOR_VIEW).t_ns(Abi.ODO_TIME_LATEST).p(0, 0, -3), "a label");
            Abi.Anchor anchor = session.anchor(label, Abi.ODO_WORLD_CORRECTED, Abi.ODO_TIME_LATEST);
            System.out.println("live " + steps + " steps " + pose.p_n(0) + " " + pose.p_n(1) + " " + pose.p_n(2) +
                String.format(Locale.ROOT, " label %.2f %.2f %.2f borrowed %d", anchor.p_n(0), anchor.p_n(1), anchor.p_n(2), Session.borrowed()));
        }
    }

    public static void main(String[] arguments) {
        if (arguments.length != 2) throw new IllegalArgumentException("usage: java Walk CONFIG.yaml RECORDING.odo");
        replay(arguments[0], arguments[1]);
        live();
    }
}
