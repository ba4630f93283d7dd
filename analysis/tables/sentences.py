"""Where the thesis says what its statements are about: number -> (section, its words in Czech, anchors of figures
here).

Anchors are those that the report gives its figures: figure-5-7 and table-5-1 answer the thesis's of that number.
"""


def _figures(first, last):
    return tuple(f"figure-5-{number}" for number in range(first, last + 1))


TABLES, MAP, KINDS, FLICKER = ("table-5-1", "table-5-2"), "map-obstacles", "map-kinds", "map-flicker"
ERRORS = "best-of-the-nine"

NAMES = {MAP: "the map of obstacles", KINDS: "the map of kinds of pass", FLICKER: "the map of flicker",
         ERRORS: "the best of the nine"}  # of anchors that are no number

SENTENCES = {
    1: ("5.1", "Nejrychlejší jsou ty nejjednodušší algoritmy a to s velmi malými rozdíly mezi sebou. Poté následují "
        "algoritmy využívající Oriented Bounding Box. S velkým odstupem jsou jako poslední algoritmy využívající FaceT "
        "data.", TABLES[:1]),
    2: ("5.2", "Veškeré hodnoty jsou mnohem vyšší než v tabulce 5.1 a kromě prohození algoritmu s vestavěnou funkcí a "
        "algoritmu s největším rozměrem a výrazného zlepšení algoritmu s novým per triangle mají i stejné pořadí.",
        TABLES[1:]),
    3: ("5.1", "Poté následují algoritmy využívající Oriented Bounding Box. S velkým odstupem jsou jako poslední "
        "algoritmy využívající FaceT data.", TABLES),
    4: ("5.2", "Veškeré hodnoty jsou mnohem vyšší než v tabulce 5.1", TABLES),
    5: ("5.1", "Obrázek 5.8 jasně ukazuje, že tento algoritmus je ze všech algoritmů ten úplně nejpomalejší.",
        (*TABLES, "figure-5-8", "figure-5-20")),
    6: ("5.4", "Tento algoritmus je téměř stejně tak přesný jako algoritmus s FaceT a per triangle a má i velmi "
               "podobnou výpočetní rychlost.", (*TABLES, "figure-5-24", "figure-5-25")),
    7: ("5.2", "Na obrázku 5.21 křivka času opět téměř vůbec nereaguje na změnu počtu kolizí.",
        ("figure-5-17", "figure-5-18", "figure-5-21", "figure-5-23")),
    8: ("5.1", "Na obrázku 5.9 je čas výpočtu mírně vyšší, ovšem výrazné zvýšení přichází až s velkým počtem objektů, "
               "na které algoritmus reaguje hůře.", ("figure-5-7", "figure-5-9")),
    9: ("6", "Sphere algoritmus zaznamenává příliš mnoho kolizí a ve srovnání s ostatními algoritmy je tak až příliš "
        "nepřesný.", ("figure-5-6", "figure-5-18")),
    10: ("5.2", "Křivka počtu kolizí má nejnižší hodnoty ze všech algoritmů.", ("figure-5-24",)),
    11: ("5.2", "ale křivky počtu kolizí jsou téměř nerozpoznatelné", ("figure-5-24", "figure-5-25")),
    12: ("5.1", "Křivka počtu kolizí je velmi podobná jako u algoritmu s vestavěnou funkcí (obrázek 5.5).",
         ("figure-5-5", "figure-5-9")),
    13: ("5.3", "Kolizi detekuje vždy až nepříjemně brzy. Jediné pozitivum je, že nikdy netvrdí, že ke kolizi "
                "nedochází, když k ní dochází.", (MAP, KINDS)),
    14: ("5.3", "Velmi dobře tak reaguje na desky a krychle. U těchto objektů je algoritmus velice přesný i u samých "
         "hranic.", (MAP,)),
    15: ("5.3", "ale u knotu je algoritmus naprosto nepřesný a i u kruhu si algoritmus myslí, že dochází ke kolizi, i "
         "když je kapsle uprostřed kruhu, kde se nic nenachází.", (MAP,)),
    16: ("5.3", "Ohledně rotace reaguje dobře na rotaci, která je blízko úhlům 90, 180, 270 a 360 stupňů.", (MAP,)),
    17: ("5.3", "Nejhorší výsledky ovšem byly u dlouhých objektů, jako deska pod úhlem 45 stupňů, kdy detekce byla "
         "detekována buď až nepříjemně příliš brzy nebo u okrajů nebyla kolize detekována vůbec.", (MAP,)),
    18: ("5.3", "Jako první algoritmus dokáže správně reagovat na prázdný prostředek kruhu a dokonce i na samotný "
                "knot.",
         (MAP,)),
    19: ("5.3", "Když jsou objekty blízko, algoritmus hlásí kolizi o trochu dříve, než by měl.", (MAP, KINDS)),
    20: ("5.3", "Algoritmus není schopen rozpoznat kolizi, pokud je malý objekt uvnitř velkého, čímž jsou stěny "
                "objektů příliš daleko od sebe.", (KINDS,)),
    21: ("5.3", "Když jsou objekty v kolizi a zároveň v pohybu, algoritmus “problíkává”.", (FLICKER,)),
    22: ("5.3", "Pokud tak dlouhá kapsle projde skrz úzkou desku, algoritmus to nezaznamená. Tento algoritmus je tak "
         "nejvíce náchylný na jev zvaný tunelování.", (MAP, KINDS)),
    23: ("5.3", "Právě při rotacích detekuje kolizi příliš brzy.", (MAP,)),
    24: ("5.3", "U objektů, jako je koule a kapsle, detekuje kolizi příliš brzy. U desky naopak reaguje naprosto "
                "přesně.",
         (MAP,)),
    25: ("5.3", "U zrotovaných desek, které jsou zrotovány ve dvou osách, je algoritmus až nepříjemně nepřesný a "
                "kolizi zachytí buď pozdě nebo vůbec.", (MAP,)),
    26: ("5.3", "Ale u rotovaných kruhů, které jsou rotovány pouze v jedné ose, reaguje algoritmus dobře a rozpozná "
         "zrotované kraje objektu. Ukázalo se tak, že algoritmus umí pracovat s úhly, ale omezeně. Ovšem stále "
         "nedokáže rozpoznat prázdný střed kruhu.", (MAP,)),
    27: ("5.3", "Také má problémy rozpoznat, zda je objekt uvnitř jiného objektu. V takovém případě ve většinou kolizi "
         "zachytí, ale občas nezachytí.", (KINDS,)),
    28: ("5.3", "Dokáže dokonce i rozpoznat prázdný střed kruhu. U knotu tu jsou jisté nepřesnosti, ovšem i tak "
                "algoritmus dokáže rozpoznat očko knotu. Největší nevýhoda je, že algoritmus nezkontroluje celý povrch "
                "objektu.",
         (MAP, FLICKER)),
    29: ("5.3", "Ovšem podobnost přesnosti s algoritmem s FaceT a per triangle je téměř shodná.", (MAP,)),
    30: ("5.4", "Algoritmus s FaceT a počítadlem vzdálenosti, algoritmus s FaceT a per triangle a algoritmus s novým "
                "per triangle mají vysokou přesnost a dokáží si poradit i s objekty, které mají velice nepravidelné "
                "tvary včetně kruhu, ale jsou velmi pomalé.", (ERRORS, MAP)),
    31: ("5.4", "Bezesporu se jedná o ten nejpřesnější algoritmus, ale také o ten nejpomalejší", (ERRORS,)),
    32: ("5.4", "Bezesporu se jedná o ten nejpřesnější algoritmus, ale také o ten nejpomalejší", TABLES),
    33: ("5.4", "Oproti tomu algoritmy využívající principu Oriented Bounding Box mají přijatelný či výborný výpočetní "
         "výkon", TABLES),
    34: ("5.4", "Oproti tomu algoritmy využívající Axis-Aligned Bounding Box a Sphere jsou využitelné pouze jako "
         "optimalizační algoritmy. Jejich vysoká rychlost a nízká (v případě algoritmu s největším rozměrem, až "
         "žalostný) přesnost tomuto odpovídají.", (ERRORS, *TABLES)),
    35: ("5.4", "Ve srovnání s ostatními Oriented Bounding Box algoritmy má tu největší přesnost a také nejlepší "
         "výpočetní výkon.", (ERRORS,)),
    36: ("5.4", "Ve srovnání s ostatními Oriented Bounding Box algoritmy má tu největší přesnost a také nejlepší "
         "výpočetní výkon.", TABLES),
    37: ("5.4", "Tento algoritmus je zcela určitě nejlepší na optimalizaci a na detekci kolizí u jednoduchých tvarů.",
         (ERRORS, *TABLES)),
    38: ("5.4", "Tento algoritmus se na detekci kolizí vůbec nehodí. Na to je až příliš nepřesný.", (ERRORS,)),
    39: ("5.4", "Pokud by ve scéně byla plocha s velkou plochou, algoritmus by selhal.", ("figure-5-18",)),
    40: ("5.4", "Pokud by se ve scéně objevil rotovaný objekt, jako rozměrná plocha nebo dlouhá tyč, algoritmus by "
         "ztratil účinnost.", (MAP,)),
    41: ("5.4", "I tento algoritmus je velmi dobře použitelný na optimalizaci i přesto, že má mírně horší výpočetní "
         "výkon.", TABLES),
    42: ("5.4", "Tento algoritmus je takovou horší verzí algoritmu s vestavěnou funkcí.", (ERRORS, *TABLES)),
    43: ("5.4", "Přestože tento algoritmus využívá FaceT a má i podobně vysokou rychlost, jeho přesnost připomíná "
                "spíše Axis-Aligned Bounding Box algoritmus.", (ERRORS, MAP)),
    44: ("5.4", "ovšem z těchto algoritmů je tento algoritmus v této podobě ten nejvíce neúčinný", (ERRORS,)),
    45: ("5.4", "u tohoto algoritmu je nepřesná u objektů s rotací v několika osách, což z něj činí zřejmě ten nejméně "
         "přesný Oriented Bounding Box algoritmus.", (ERRORS, MAP)),
    46: ("5.4", "Tento algoritmus je téměř tak přesný jako algoritmus s FaceT a počítadlem vzdálenosti, ale je o něco "
         "rychlejší", (ERRORS,)),
    47: ("5.4", "Tento algoritmus je téměř tak přesný jako algoritmus s FaceT a počítadlem vzdálenosti, ale je o něco "
         "rychlejší", TABLES),
    48: ("5.4", "Tento algoritmus je téměř stejně tak přesný jako algoritmus s FaceT a per triangle a má i velmi "
                "podobnou výpočetní rychlost.", (ERRORS, *TABLES)),
    49: ("5.4", "Jelikož je tento algoritmus plně originální, nepoužívá pro detekci kolizí převzaté funkce, s "
         "optimalizací je přijatelně rychlý a má výbornou přesnost, tak se dá považovat za nejvíce úspěšný algoritmus.",
         (ERRORS,)),
    50: ("5.4", "Ukázalo se také, že ve srovnání s knihovnou Cannon.js si jsou algoritmy velmi podobné při testování v "
         "testovací aplikaci Kostka. Křivky grafů mají velmi podobný tvar a to jak u počtu kolizí, tak u výpočetního "
         "času.", _figures(1, 13)),
    51: ("5.4", "Cannon.js zachytí nejvíce kolizí spíše ke konci, ale algoritmy spíše na začátku.", _figures(14, 25)),
    52: ("5.4", "U Cannon.js výpočetní čas neustále stoupá, ale u algoritmů je víceméně stálý nebo dokonce klesá.",
         _figures(14, 25)),
    53: ("6", "Sphere algoritmus zaznamenává příliš mnoho kolizí a ve srovnání s ostatními algoritmy je tak až příliš "
         "nepřesný.", ("figure-5-6", "figure-5-18")),
    54: ("6", "Axis-Aligned Bounding Box a Oriented Bounding Box algoritmy zaznamenávají srovnatelný počet kolizí",
         ("figure-5-7", "figure-5-9", "figure-5-19", "figure-5-21")),
    55: ("6", "ovšem Axis-Aligned Bounding Box algoritmus má výrazně nižší čas.",
         ("figure-5-7", "figure-5-9", "figure-5-19", "figure-5-21", *TABLES)),
    56: ("6", "Mezi nejcennější poznatky patří, že k velké přesnosti je dobré použít FaceT informace, což algoritmy "
         "využívající tyto informace potvrdily.", (ERRORS,)),
    57: ("5.2", "Největším přínosem je, že algoritmus s OBB a per triangle je znatelně rychlejší než algoritmus s OBB, "
         "zatímco při měření v aplikaci Kostka měly tyto algoritmy časy velmi podobné.", TABLES),
}

# number of the thesis's figure -> its words about it; its own words where several figures share them.
FIGURES = {
    "5.1": "Zajímavé je, že kolizní čas se nevychyluje tak moc jako fyzikální čas.",
    "5.2": "Fyzikální čas reaguje na výchyly v počtu kolizí mnohem citlivěji než kolizní čas.",
    "5.3": "Fyzikální čas reaguje na výchyly v počtu kolizí mnohem citlivěji než kolizní čas.",
    "5.4": "Až na několik počátečních výkyvů, dává graf stálá data.",
    "5.5": "Podle obrázku 5.5 algoritmus na změnu počtu kolizí a objektů téměř vůbec nereaguje a zachovává si stabilní "
           "a nízký čas výpočtu po celou dobu.",
    "5.6": "Podle obrázku 5.6 algoritmus na změnu počtu kolizí a objektů, reaguje naprosto minimálně a zachovává si "
           "stabilní a nízký čas výpočtu po celou dobu. Zaznamenává ovšem poměrně mnoho kolizí.",
    "5.7": "Na obrázku 5.7 je vidět, že algoritmus už je mírně pomalejší než předchozí algoritmy (obrázek 5.5 a "
           "obrázek 5.6). Křivka záznamu kolizí nemá příliš podobný průběh jako křivka zvýšení počtu objektů.",
    "5.8": "Obrázek 5.8 jasně ukazuje, že tento algoritmus je ze všech algoritmů ten úplně nejpomalejší. Křivka ovšem "
           "nějak výrazně neroste ani s rostoucím počtem objektů.",
    "5.9": "Na obrázku 5.9 je čas výpočtu mírně vyšší, ovšem výrazné zvýšení přichází až s velkým počtem objektů, na "
           "které algoritmus reaguje hůře. Křivka počtu kolizí je velmi podobná jako u algoritmu s vestavěnou funkcí "
           "(obrázek 5.5).",
    "5.10": "Na obrázku 5.10 jsou křivky počtu objektů a počtu kolizí velmi podobné jako u algoritmu s vestavěnou "
            "funkcí a algoritmu s OBB (obrázek 5.5 a obrázek 5.9).",
    "5.11": "Na obrázku 5.11 jsou křivky počtu kolizí a času výpočtu velmi kolísavé. Především u křivky počtu kolizí "
            "se tyto výkyvy velmi výrazně zhorší s vyšším počtem objektů.",
    "5.12": "Na obrázku 5.12 čas výpočtu obsahuje velké výkyvy a samotný čas je velice vysoký.",
    "5.13": "Na obrázku 5.13 jsou obě křivky téměř stejné jako u algoritmu s FaceT a per triangle (obrázek 5.12).",
    "5.14": "Je vidět, že kolizní čas se opět nevychyluje tak moc jako fyzikální čas, stejně jako na obrázku 5.1.",
    "5.15": "Fyzikální čas opět reaguje na výchylinky v počtu kolizí mnohem citlivěji než kolizní čas, stejně jako na "
            "obrázku 5.2.",
    "5.16": "Výkyvy na začátku již nejsou tak velké jako u 1.aplikace, Kostka. Poté graf dává stálá data, která jsou "
            "ovšem vyšší než v aplikaci Kostka (obrázek 5.4).",
    "5.17": "Na obrázku 5.17 je čas výpočtu opět velmi nízký a velmi stálý po celou dobu.",
    "5.18": "I na obrázku 5.18 je čas výpočtu stále velmi nízký a velmi stálý po celou dobu, ale s výrazně vyšším "
            "počtem kolizí.",
    "5.19": "I na obrázku 5.19 je čas výpočtu stále velmi nízký s několika výkyvy, ale s menším počtem kolizí.",
    "5.20": "Na obrázku 5.20 je čas extrémně vysoký a naprosto nestálý. Je nejvyšší ze všech algoritmů. Křivka času "
            "vůbec nemění svůj tvar podle křivky počtu kolizí, ale naprosto chaoticky.",
    "5.21": "Na obrázku 5.21 křivka času opět téměř vůbec nereaguje na změnu počtu kolizí. Čas výpočtu je stálý a "
            "nízký, ovšem mírně vyšší než u některých algoritmů.",
    "5.22": "Na obrázku 5.22 je čas výpočtu stálý, ale také velmi vysoký. Křivka počtu kolizí je poměrně nízká.",
    "5.23": "Na obrázku 5.23 je čas výpočtu nízký a stálý. Křivka počtu kolizí je spíše standardní, jak tvarem, tak "
            "hodnotami.",
    "5.24": "Na obrázku 5.24 je čas výpočtu vysoký a nemá žádný řád ani postup. Na jejím stoupání a klesání není vidět "
            "žádný vztah s křivkou počtu kolizí. Křivka počtu kolizí má nejnižší hodnoty ze všech algoritmů.",
    "5.25": "Na obrázku 5.25 má v porovnání s obrázkem 5.24 (algoritmus s FaceT a per triangle) mírně nižší hodnoty "
            "času, ale křivky počtu kolizí jsou téměř nerozpoznatelné.",
}
