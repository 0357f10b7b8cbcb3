// SPDX-License-Identifier: Apache-2.0
package org.odograph.phone

import android.Manifest.permission.CAMERA
import android.app.Activity
import android.content.pm.PackageManager.PERMISSION_GRANTED
import android.os.Bundle
import android.os.Handler
import android.os.Looper
import android.view.WindowManager.LayoutParams.FLAG_KEEP_SCREEN_ON
import android.widget.TextView
import kotlin.math.sqrt

/** Tracks and shows the phone's position while visible. A tap puts a mark on what lies in the middle of the picture; it is there again
 * when the app is opened another time at the same place. */
class MainActivity : Activity() {
    private lateinit var text: TextView
    private var mark = 0L
    private val handler = Handler(Looper.getMainLooper())
    private val show = object : Runnable {
        override fun run() {
            text.text = Tracker.pose()?.let {
                val unit = if (it[4] > 0) "m" else "(scale unknown)"
                "%s\nnorth %.2f, east %.2f, up %.2f %s\nwalked %.1f m%s".format(
                    Tracker.stateText(it[3].toInt()), it[0], it[1], -it[2], unit, it[5], placed())
            } ?: "move the phone"
            handler.postDelayed(this, 100)
        }
    }

    private fun placed() = Tracker.anchor(mark)?.let { "\nmark %.2f m away".format(sqrt(it[0] * it[0] + it[1] * it[1] + it[2] * it[2])) } ?: ""

    private fun place() {
        val made = Tracker.place(0.5, 0.5)
        if (made != 0L) mark = made  // otherwise: move the phone
    }

    override fun onCreate(state: Bundle?) {
        super.onCreate(state)
        window.addFlags(FLAG_KEEP_SCREEN_ON)
        text = TextView(this).apply { textSize = 24f; setPadding(48, 160, 48, 48) }
        text.setOnClickListener { place() }
        setContentView(text)
        if (checkSelfPermission(CAMERA) != PERMISSION_GRANTED) requestPermissions(arrayOf(CAMERA), 1)
    }

    override fun onResume() {
        super.onResume()
        if (checkSelfPermission(CAMERA) != PERMISSION_GRANTED) {
            text.text = "Odograph needs the camera."
            return
        }
        val wrong = Tracker.start(assets.open("pipeline.yaml").bufferedReader().readText(), filesDir.resolve("place.map").path)
        mark = Tracker.mark()
        if (wrong.isEmpty()) handler.post(show) else text.text = wrong
    }

    override fun onPause() {
        handler.removeCallbacks(show)
        Tracker.stop()
        super.onPause()
    }
}
