// SPDX-License-Identifier: Apache-2.0
plugins {
    id("com.android.application")
    id("org.jetbrains.kotlin.android")
}

android {
    namespace = "org.odograph.phone"
    compileSdk = 35
    ndkVersion = "27.2.12479018"

    defaultConfig {
        applicationId = "org.odograph.phone"
        minSdk = 28
        targetSdk = 35
        versionCode = 1
        versionName = "0.1"
        ndk { abiFilters += "arm64-v8a" }
        externalNativeBuild {
            cmake {
                arguments += listOf(
                    "-DANDROID_STL=c++_static",
                    // -P odograph=PATH: Odograph's sources. -P dependencies=PATH: where README.md's list is installed.
                    "-DODOGRAPH_SOURCE=${project.findProperty("odograph") ?: rootDir.resolve("../..")}",
                    "-DCMAKE_FIND_ROOT_PATH=${project.findProperty("dependencies") ?: ""}",
                )
                targets += "odograph_phone"
            }
        }
    }
    externalNativeBuild { cmake { path = file("src/main/cpp/CMakeLists.txt") } }
    compileOptions {
        sourceCompatibility = JavaVersion.VERSION_17
        targetCompatibility = JavaVersion.VERSION_17
    }
    kotlinOptions { jvmTarget = "17" }
}
