"""deploy/kubernetes/ is what Kubernetes takes and what this server is: each overlay is built, held against Kubernetes' published schemas,
and its flags, metrics, ports, paths and sizes against the server's and each other.

    kubernetes_test.py FOLDER-OF-THE-PROGRAMS
"""
import copy
import json
import os
import re
import shutil
import subprocess
import sys
import tempfile
import unittest

HERE = os.path.dirname(os.path.abspath(__file__))
ROOT = os.path.realpath(os.path.join(HERE, "..", ".."))
KUBERNETES = os.path.join(ROOT, "deploy", "kubernetes")
OVERLAYS = ("cpu", "nvidia")
COMPONENTS = ("monitoring", "autoscaling")
UNITS = {"": 1, "Ki": 2**10, "Mi": 2**20, "Gi": 2**30, "K": 2**10, "M": 2**20, "G": 2**30}  # the last three as Scancast reads them
programs = ""


def text_of(*path):
    with open(os.path.join(ROOT, *path), encoding="utf-8") as file:
        return file.read()


def skip(why, way_out):
    print(f"\nSKIPPED: {why}; {way_out}", flush=True)
    raise unittest.SkipTest(why)


def output_of(command, **more):
    done = subprocess.run(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, timeout=120, check=False, **more)
    if done.returncode:
        raise AssertionError(f"{' '.join(command)} ended with {done.returncode}:\n{done.stdout[-2000:]}{done.stderr[-2000:]}")
    return done.stdout


def kubectl(*arguments, **more):
    return output_of(["kubectl", *arguments], **more)


def objects_of(yaml):
    """A list of what the documents say. kubectl reads them, as it does before it sends them; nothing else here reads YAML."""
    text = kubectl("annotate", "--local", "-o", "json", "-f", "-", "read.by/test=yes", input=yaml)
    decoder, objects, at = json.JSONDecoder(), [], 0
    while text[at:].strip():
        at += len(text[at:]) - len(text[at:].lstrip())
        found, length = decoder.raw_decode(text[at:])
        objects.append(found)
        at += length
    return objects


def built(overlay, components):
    with tempfile.TemporaryDirectory() as folder:
        def lines(key, *path, names):
            return f"{key}:\n" + "".join(f"  - {os.path.relpath(os.path.join(KUBERNETES, *path, name), os.path.realpath(folder))}\n"
                                         for name in names)
        with open(os.path.join(folder, "kustomization.yaml"), "w", encoding="utf-8") as file:
            file.write("apiVersion: kustomize.config.k8s.io/v1beta1\nkind: Kustomization\n" +
                       lines("resources", "overlays", names=[overlay]) +
                       (lines("components", "components", names=components) if components else ""))
        return objects_of(kubectl("kustomize", folder))


def judged(objects):
    """What the schemas have against the objects, a line each."""
    for package, folder in (("kubernetes-models", "foreign"), ("@kubernetes-models/prometheus-operator", "foreign"), ("typescript", "browser")):
        if not os.path.exists(os.path.join(ROOT, "tests", folder, "node_modules", package, "package.json")):
            skip(f"npm's {package} is missing, so no object is held against the schemas", f"(cd tests/{folder} && npm ci --ignore-scripts)")
    if not shutil.which("node"):
        skip("Node.js is missing, so no object is held against the schemas", "apt-get install nodejs")
    done = subprocess.run(["node", os.path.join(ROOT, "tests", "foreign", "kubernetes_schema.mjs")], input=json.dumps(objects),
                          stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, timeout=300, check=False)
    if done.returncode not in (0, 1):
        raise AssertionError(f"the schemas could not be read:\n{done.stderr[-2000:]}")
    return done.stdout.splitlines()


def size(text):
    number, unit = re.fullmatch(r"([\d.]+)(\w*)", text).groups()
    return float(number) * UNITS[unit]


def metrics():
    return set(re.findall(r'\.Name\("(\w+)"\)', text_of("server", "base", "metrics.cpp")))


class Kubernetes(unittest.TestCase):
    variants = {}

    @classmethod
    def setUpClass(cls):
        if not shutil.which("kubectl"):
            skip("kubectl is missing, so deploy/kubernetes is not read", "install it from kubernetes.io; Debian 12's is too old")
        for overlay in OVERLAYS:
            for components in ((), COMPONENTS):
                cls.variants[overlay, components] = built(overlay, components)
        cls.stored = [built(overlay, (*COMPONENTS, "object-storage")) for overlay in OVERLAYS]
        cls.loader = objects_of(text_of("deploy", "kubernetes", "loader", "pod.yaml"))

    def each(self):
        return self.variants.values()

    def one(self, objects, kind):
        found = [one for one in objects if one["kind"] == kind]
        self.assertEqual(len(found), 1, kind)
        return found[0]

    def pod(self, objects):
        template = self.one(objects, "Deployment")["spec"]["template"]
        return template["metadata"], template["spec"], template["spec"]["containers"][0]

    def settings(self, objects):
        _, _, container = self.pod(objects)
        named = container["envFrom"][0]["configMapRef"]["name"]
        kept = self.one(objects, "ConfigMap")
        self.assertEqual(kept["metadata"]["name"], named)
        return {**kept["data"], **{one["name"]: one["value"] for one in container["env"]}}

    # What Kubernetes wants.

    def test_every_object_is_as_the_schemas_want_it(self):
        everything = [one for objects in (*self.variants.values(), *self.stored) for one in objects] + self.loader
        self.assertEqual({one["kind"] for one in everything},
                         {"Namespace", "ConfigMap", "Service", "PersistentVolumeClaim", "Deployment", "PodDisruptionBudget", "Ingress",
                          "NetworkPolicy", "ServiceMonitor", "HorizontalPodAutoscaler", "Pod"})
        self.assertEqual(judged(everything), [])

    def test_what_is_misspelt_is_found(self):
        """Or the test above would prove nothing."""
        objects = self.variants["cpu", COMPONENTS]

        def change(kind, change_it):
            changed = copy.deepcopy(self.one(objects, kind))
            change_it(changed)
            return changed

        def container(deployment):
            return deployment["spec"]["template"]["spec"]["containers"][0]

        spoiled = {
            "a field that is not there": change("Deployment", lambda o: container(o)["readinessProbe"].update(periodSecond=5)),
            "one deep down": change("Deployment", lambda o: container(o)["securityContext"].update(readonlyRootFilesystem=True)),
            "a number as a word": change("Deployment", lambda o: o["spec"].update(replicas="two")),
            "what is required": change("Deployment", lambda o: o["spec"].pop("selector")),
            "a word that is none of its": change("Ingress", lambda o: o["spec"]["rules"][0]["http"]["paths"][0].pop("pathType")),
            "another object's field": change("PodDisruptionBudget", lambda o: o["spec"].update(replicas=2)),
            "an operator's object": change("ServiceMonitor", lambda o: o["spec"]["endpoints"][0].update(ports="admin")),
            "a version that is not there": change("HorizontalPodAutoscaler", lambda o: o.update(apiVersion="autoscaling/v3")),
        }
        for number, one in enumerate(spoiled.values()):
            one["metadata"]["name"] = f"spoiled-{number}"
        found = judged(list(spoiled.values()))
        for what, one in spoiled.items():
            with self.subTest(what):
                self.assertTrue([line for line in found if line.startswith(f"{one['kind']} {one['metadata']['name']}: ")], found)

    def test_whom_selectors_mean(self):
        for objects in self.each():
            labels, spec, _ = self.pod(objects)
            labels = labels["labels"]
            selectors = [self.one(objects, "Service")["spec"]["selector"], spec["topologySpreadConstraints"][0]["labelSelector"]["matchLabels"],
                         self.one(objects, "PodDisruptionBudget")["spec"]["selector"]["matchLabels"],
                         self.one(objects, "Deployment")["spec"]["selector"]["matchLabels"]]
            for selector in selectors:
                self.assertTrue(selector)
                self.assertLessEqual(selector.items(), labels.items())
                self.assertFalse(selector.items() <= self.loader[0]["metadata"]["labels"].items(), "nobody is sent to the loader")
            self.assertEqual(self.one(objects, "NetworkPolicy")["spec"]["podSelector"], {}, "holds for all pods of the namespace")
            self.assertEqual(self.one(objects, "NetworkPolicy")["spec"].get("egress", []), [])

    def test_pods_may_do_nothing_that_they_need_not(self):
        for objects in self.each():
            for spec in (self.pod(objects)[1], self.loader[0]["spec"]):
                context = spec["securityContext"]
                self.assertTrue(context["runAsNonRoot"])
                self.assertIn(f"useradd --uid {context['runAsUser']} ", text_of("deploy", "container", "Containerfile"))
                self.assertEqual(context["seccompProfile"], {"type": "RuntimeDefault"})
                self.assertIs(spec["automountServiceAccountToken"], False)
                for container in spec["containers"]:
                    inner = container["securityContext"]
                    self.assertEqual((inner["allowPrivilegeEscalation"], inner["readOnlyRootFilesystem"], inner["capabilities"]),
                                     (False, True, {"drop": ["ALL"]}))
            self.assertEqual(self.one(objects, "Namespace")["metadata"]["labels"]["pod-security.kubernetes.io/enforce"], "restricted")
            self.assertNotIn("Secret", {one["kind"] for one in objects}, "secrets are made by people")

    # What the server is.

    def test_every_setting_is_a_flag_of_the_server_and_all_are_sound(self):
        for objects in self.each():
            settings = self.settings(objects)
            known = set(re.findall(r"\(Env:(SCANCAST_\w+)\)", output_of([os.path.join(programs, "scancast"), "serve", "--help"])))
            self.assertGreater(len(known), 30)
            self.assertLessEqual(set(settings), known | {"NVIDIA_DRIVER_CAPABILITIES"})
            with tempfile.TemporaryDirectory() as folder:
                os.makedirs(os.path.join(folder, "clouds"))
                os.makedirs(os.path.join(folder, "cache"))
                for name, line in (("token", "0f7d5cb8e1a94263b7c85d0e6f1a2b93"), ("session-key", "sessions 5a1e9c07d3b84f62a0c7e8d91b24f635")):
                    with open(os.path.join(folder, name), "w", encoding="ascii", opener=lambda path, how: os.open(path, how, 0o400)) as file:
                        file.write(line + "\n")
                places = {"/run/secrets/scancast": folder, "/clouds": os.path.join(folder, "clouds")}
                for name, value in settings.items():
                    for there, here in places.items():
                        value = value.replace(there, here)
                    settings[name] = value
                environment = {**os.environ, **settings, "SCANCAST_HOST": "0.0.0.0", "SCANCAST_CACHE_DIR": os.path.join(folder, "cache")}
                in_effect = json.loads(output_of([os.path.join(programs, "scancast"), "serve", "--check-config"], env=environment))
                self.assertEqual(in_effect["memory-limit"], settings["SCANCAST_MEMORY_LIMIT"])

    def test_ports_and_paths_are_there(self):
        routes = set(re.findall(r'RouteInfo\{Route::\w+, "([^"]+)"', text_of("server", "net", "api", "router.hpp")))
        for objects in self.each():
            settings, (_, _, container) = self.settings(objects), self.pod(objects)
            ports = {port["name"]: port["containerPort"] for port in container["ports"]}
            image = dict(re.findall(r"(SCANCAST_\w+)=(\S+)", text_of("deploy", "container", "Containerfile")))
            self.assertEqual(ports, {"http": int(image["SCANCAST_PORT"]), "admin": int(settings["SCANCAST_ADMIN_LISTEN"].rsplit(":", 1)[1])})
            for probe, path in (("startupProbe", "/healthz"), ("readinessProbe", "/readyz"), ("livenessProbe", "/healthz")):
                asked = container[probe]["httpGet"]
                self.assertEqual((asked["path"], asked["port"]), (path, "admin"))
                self.assertIn(path, routes)
            service = {port["name"]: port["targetPort"] for port in self.one(objects, "Service")["spec"]["ports"]}
            self.assertLessEqual(set(service.values()), set(ports))
            rule = self.one(objects, "Ingress")["spec"]["rules"][0]
            self.assertIn(rule["http"]["paths"][0]["backend"]["service"]["port"]["name"], service)
            self.assertEqual(rule["host"], settings["SCANCAST_ALLOWED_HOST"])
            let_in = {port["port"] for one in self.one(objects, "NetworkPolicy")["spec"]["ingress"] for port in one["ports"]}
            self.assertEqual(let_in, set(ports))
            for monitor in (one for one in objects if one["kind"] == "ServiceMonitor"):
                endpoint = monitor["spec"]["endpoints"][0]
                self.assertIn(endpoint["port"], service)
                self.assertIn(endpoint["path"], routes)
                self.assertEqual(endpoint["authorization"]["credentials"], {"name": "scancast", "key": "token"})
                label = monitor["spec"]["jobLabel"]
                self.assertEqual(self.one(objects, "Service")["metadata"]["labels"][label], "scancast", "the job, as the alert rules want it")

    def test_secrets_and_folders_are_where_the_settings_say(self):
        made = set(re.findall(r"--from-file=([\w-]+)", text_of("deploy", "kubernetes", "README.md")))
        image = text_of("deploy", "container", "Containerfile")
        for objects in self.each():
            settings, (_, spec, container) = self.settings(objects), self.pod(objects)
            mounts = {one["name"]: one["mountPath"] for one in container["volumeMounts"]}
            files = [settings["SCANCAST_AUTH_TOKEN_FILE"], settings["SCANCAST_SESSION_KEY_FILE"]]
            self.assertEqual({os.path.basename(file) for file in files}, made)
            self.assertEqual({os.path.dirname(file) for file in files}, {mounts["secrets"]})
            self.assertEqual(settings["SCANCAST_CATALOG"], mounts["clouds"])
            self.assertIn(f"SCANCAST_CACHE_DIR={mounts['cache']} ", image)
            volumes = {one["name"]: one for one in spec["volumes"]}
            self.assertEqual(set(volumes), set(mounts))
            self.assertEqual(volumes["secrets"]["secret"]["defaultMode"], 0o400)
            self.assertEqual(container["image"], self.loader[0]["spec"]["containers"][0]["image"])

    def test_with_object_storage_nothing_of_the_volume_is_left(self):
        for objects in self.stored:
            settings, (_, spec, container) = self.settings(objects), self.pod(objects)
            self.assertNotIn("SCANCAST_CATALOG", settings)
            self.assertNotIn("PersistentVolumeClaim", {one["kind"] for one in objects})
            self.assertEqual({one["name"] for one in spec["volumes"]}, {"secrets", "cache", "tmp"})
            self.assertEqual({one["name"] for one in container["volumeMounts"]}, {"secrets", "cache", "tmp"})
            self.assertTrue(all(one.startswith("s3://") for one in container["args"]))
            self.assertEqual(container["envFrom"][1], {"secretRef": {"name": "scancast-bucket", "optional": True}})
            self.assertEqual({port["port"] for one in self.one(objects, "NetworkPolicy")["spec"]["egress"] for port in one["ports"]}, {53, 443})

    def test_the_autoscaler_asks_for_what_the_adapter_makes_of_what_the_server_tells(self):
        rules = text_of("deploy", "kubernetes", "prometheus-adapter.yaml")
        made = dict(zip(re.findall(r"name: \{as: (\w+)\}", rules), re.findall(r"seriesQuery: '(\w+)\{", rules)))
        self.assertEqual(len(made), rules.count("metricsQuery:"))
        self.assertLessEqual(set(made.values()), metrics())
        for overlay in OVERLAYS:
            objects = self.variants[overlay, COMPONENTS]
            scaler = self.one(objects, "HorizontalPodAutoscaler")["spec"]
            asked = {one["pods"]["metric"]["name"]: one["pods"]["target"]["averageValue"] for one in scaler["metrics"]}
            self.assertEqual(set(asked), set(made))
            self.assertEqual(scaler["scaleTargetRef"]["name"], self.one(objects, "Deployment")["metadata"]["name"])
            self.assertNotIn("replicas", self.one(objects, "Deployment")["spec"], "apply would undo what the autoscaler did")
            self.assertEqual(int(asked["scancast_sessions"]), int(self.settings(objects)["SCANCAST_MAX_SESSIONS"]) * 3 // 4)

    # Each other.

    def test_sizes_agree(self):
        for objects in self.each():
            settings, (_, spec, container) = self.settings(objects), self.pod(objects)
            limits, volumes = container["resources"]["limits"], {one["name"]: one for one in spec["volumes"]}
            wanted = 1.25 * size(settings["SCANCAST_MEMORY_LIMIT"]) + int(settings["SCANCAST_IMPORTERS"]) * size(settings["SCANCAST_IMPORTER_MEMORY"])
            self.assertLessEqual(wanted, size(limits["memory"]))
            self.assertEqual({name: container["resources"]["requests"][name] for name in ("cpu", "memory")},
                             {name: limits[name] for name in ("cpu", "memory")}, "frames wait where neighbours take turns")
            self.assertLess(size(settings["SCANCAST_CACHE_SIZE"]), size(volumes["cache"]["emptyDir"]["sizeLimit"]))
            self.assertLess(size(volumes["cache"]["emptyDir"]["sizeLimit"]), size(limits["ephemeral-storage"]))
            before = int(container["lifecycle"]["preStop"]["exec"]["command"][1])
            self.assertGreaterEqual(spec["terminationGracePeriodSeconds"], before + int(settings["SCANCAST_DRAIN_SECONDS"]) + 30 + 5)

    def test_a_replica_of_the_nvidia_overlay_has_a_gpu(self):
        for overlay, gpus in (("cpu", None), ("nvidia", "1")):
            self.assertEqual(self.pod(self.variants[overlay, ()])[2]["resources"]["limits"].get("nvidia.com/gpu"), gpus)


if __name__ == "__main__":
    programs = sys.argv.pop(1)
    unittest.main()
