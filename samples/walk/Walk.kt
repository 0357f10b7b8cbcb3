// SPDX-License-Identifier: Apache-2.0
import java.nio.ByteBuffer
import java.util.Locale
import java.util.concurrent.atomic.AtomicInteger
import java.util.function.Consumer
import org.odograph.Abi
import org.odograph.Event
import org.odograph.Recording
import org.odograph.Session

const val CONFIG = """odograph: 1
walker: {height: 1.70 m}
attitude: {plugin: attitude/vqf}
step_estimator: {plugin: step/odograph}
coupling: {type: localizer}
navigation: {start: {position: [0 m, 0 m, 0 m], heading: 0 deg}}
"""

fun show(event: Event) {
    if (event.type() == Abi.ODO_TYPE_POINTS) { // landmarks, the most certain first
        val first = event.point(0)
        return println("points ${event.points()} first ${first.id()} ${first.p_c(2).toDouble()}")
    }
    val pose = Abi.Pose(event)
    val (x, y, z) = pose.p_n()
    val (qw, qx, qy, qz) = pose.q_n()
    println("pose ${pose.t_ns()} $x $y $z $qx $qy $qz $qw")
}

/** Offset of the pixels of a grey picture. PGM needs no library; an app decodes JPEG and PNG with its own library. */
fun decode(picture: ByteBuffer, frame: Abi.Frame): Int {
    val words = String(ByteArray(24).also { picture.duplicate().get(it) }, Charsets.US_ASCII).split(' ', '\n').take(4)
    frame.format(Abi.ODO_FORMAT_GREY8).width(words[1].toInt()).height(words[2].toInt())
    return words.map { it.length + 1 }.sum()
}

/** Puts an anchor on what lies ahead, 45 degrees down: usually the floor. */
fun place(session: Session) {
    val hit = session.hitTest(Abi.Ray().kind(Abi.ODO_RAY_VIEW).t_ns(Abi.ODO_TIME_LATEST).direction(0.0, 1.0, 1.0)) ?: return
    val anchor = session.createAnchor(Session.placeOf(hit, Abi.ODO_WORLD_CORRECTED), "on the floor")
    println("hit ${hit.what()} ${hit.surface()} ${hit.distance_m()} anchor $anchor")
}

fun replay(config: String, file: String) = Session(config).use { session ->
    session.onEvent(Consumer { show(it) }, Abi.ODO_TYPE_POSE, Abi.ODO_TYPE_POINTS)
    Recording(file).use { recording ->
        for (recorded in recording) {
            val encoded = recorded.picture
            if (encoded != null) {
                val frame = Abi.Frame(recorded.message)
                val begin = decode(encoded, frame)
                session.pushFrame(frame, ByteBuffer.allocateDirect(encoded.capacity()).put(encoded), begin, frame.width())
            } else if (recorded.message.isInput) {
                session.push(recorded.message)
            }
        }
    }
    session.flush()
    place(session)
}

fun live() {
    val steps = AtomicInteger()
    val picture = ByteBuffer.allocateDirect(64 * 48) // as from a camera
    while (picture.hasRemaining()) picture.put(90)
    Session(CONFIG, true, "").use { session ->
        session.onEvent(Consumer { steps.incrementAndGet() }, Abi.ODO_TYPE_STEP)
        val imu = Abi.Imu(0).flags(Abi.ODO_IMU_GYRO or Abi.ODO_IMU_ACCEL)
        val frame = Abi.Frame(0).format(Abi.ODO_FORMAT_GREY8).width(64).height(48)
        for (i in 0 until 1000) {
            val t = i * 0.01
            val tNs = 1_000_000_000L + i * 10_000_000L
            session.push(imu.t_ns(tNs).gyro_b(0.0, 0.01, 0.0).accel_b(0.1, 9.81 + 2.2 * Math.sin(12 * t), 0.4))
            if (i % 10 != 0) continue
            session.pushFrame(frame.t_ns(tNs), picture, 0, 64) // shared, not copied
            session.flush() // needed only because the simulated time does not wait
        }
        val (north, east, down) = session.pose().p_n()
        val place = Abi.AnchorPlace().kind(Abi.ODO_ANCHOR_VIEW).t_ns(Abi.ODO_TIME_LATEST).p(0.0, 0.0, -3.0)
        val anchor = session.anchor(session.createAnchor(place, "a label"), Abi.ODO_WORLD_CORRECTED, Abi.ODO_TIME_LATEST)
        val label = anchor.p_n().joinToString(" ") { "%.2f".format(Locale.ROOT, it) }
        println("live $steps steps $north $east $down label $label borrowed ${Session.borrowed()}")
    }
}

fun main(arguments: Array<String>) {
    require(arguments.size == 2) { "usage: kotlin WalkKt CONFIG.yaml RECORDING.odo" }
    replay(arguments[0], arguments[1])
    live()
}
